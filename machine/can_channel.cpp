// SPDX-License-Identifier: Apache-2.0
#include "machine/can_channel.hpp"

#include <algorithm>

#include "firmware_if/canopen/401/objects.hpp"
#include "firmware_if/canopen/406/objects.hpp"

namespace servogate::machine {

namespace {

/// Channels of one kind: so many of them to an object, sub-indices counted on.
struct Row {
  DeviceKind device;
  ChannelKind channel;
  std::uint16_t index;
  std::uint8_t first_subindex;
  std::uint8_t bits;  ///< of an object
  int channels;       ///< in an object
  int objects;        ///< in a row
};
constexpr Row kRows[] = {
    {DeviceKind::canopen_io, ChannelKind::di, canopen::io::kReadInput8, 1, 8, 8, 254},
    {DeviceKind::canopen_io, ChannelKind::dq, canopen::io::kWriteOutput8, 1, 8, 8, 254},
    {DeviceKind::canopen_io, ChannelKind::ai, canopen::io::kReadAnalogueInput16, 1, 16, 1, 254},
    {DeviceKind::canopen_io, ChannelKind::aq, canopen::io::kWriteAnalogueOutput16, 1, 16, 1, 254},
    {DeviceKind::canopen_encoder, ChannelKind::di, canopen::encoder::kAlarms, 0, 16, 16, 1},
    {DeviceKind::canopen_encoder, ChannelKind::ai, canopen::encoder::kPositionValue, 0, 32, 1, 1},
};

}  // namespace

std::optional<ChannelObject> channel_object(DeviceKind kind, ChannelKind channel, int number) {
  if (kind == DeviceKind::canopen_encoder && channel == ChannelKind::ai && number == 1)
    return ChannelObject{{canopen::encoder::kSpeedValue, 1, 16}, -1};
  for (const Row& row : kRows) {
    if (row.device != kind || row.channel != channel || number < 0 || number / row.channels >= row.objects)
      continue;
    const auto sub = static_cast<std::uint8_t>(row.first_subindex + number / row.channels);
    return ChannelObject{{row.index, sub, row.bits},
                         static_cast<std::int8_t>(row.channels > 1 ? number % row.channels : -1)};
  }
  return std::nullopt;
}

const PdoConfig* pdo_with(const std::vector<PdoConfig>& pdos, const PdoObject& object) {
  for (const PdoConfig& pdo : pdos)
    for (const PdoObject& o : pdo.objects)
      if (o.index == object.index && o.subindex == object.subindex && o.bits == object.bits) return &pdo;
  return nullptr;
}

int mapped_subindices(const std::vector<PdoConfig>& pdos, std::uint16_t index) {
  int highest = 0;
  for (const PdoConfig& pdo : pdos)
    for (const PdoObject& o : pdo.objects)
      if (o.index == index) highest = std::max<int>(highest, o.subindex);
  return highest;
}

}  // namespace servogate::machine
