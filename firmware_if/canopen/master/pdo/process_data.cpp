// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/pdo/process_data.hpp"

#include <algorithm>
#include <span>

namespace servogate::canopen {
namespace {
constexpr std::uint8_t kLastSyncType = 240;
constexpr image::Nanoseconds kRefreshNs = 100 * image::kMillisecond;
}  // namespace

PdoField find_field(const std::array<PdoWanted, 4>& pdos, std::uint16_t index,
                    std::uint8_t subindex) noexcept {
  for (std::size_t pdo = 0; pdo < pdos.size(); ++pdo) {
    std::uint32_t offset = 0;
    for (const MappingEntry& entry : pdos[pdo].mapping.used()) {
      if (entry.index == index && entry.subindex == subindex)
        return {static_cast<std::int8_t>(pdo), static_cast<std::uint8_t>(offset), entry.bits};
      offset += entry.bits;
    }
  }
  return {};
}

ProcessData::ProcessData(const DriveProfile& profile, image::Nanoseconds cycle_ns) {
  for (std::size_t i = 0; i < 4; ++i) {
    const PdoWanted& wanted = profile.rpdo[i];
    rpdo_[i].bytes = wanted.mapping.bytes();
    rpdo_[i].type = wanted.transmission_type;
    // Twice within the drive's deadline, so that one lost frame does no harm.
    rpdo_[i].refresh_ns = wanted.event_ms ? wanted.event_ms * image::kMillisecond / 2 : kRefreshNs;
    tpdo_bytes_[i] = profile.tpdo[i].mapping.bytes();
    if (const PdoWanted& asked = profile.tpdo[i]; asked.used() && asked.remote())
      ask_every_[i] = std::max<std::int64_t>(1, asked.event_ms * image::kMillisecond / cycle_ns);
  }
  for (const SdoSetting& setting : profile.settings)
    set(find_field(profile.rpdo, setting.index, setting.subindex), setting.value);
  for (Rpdo& pdo : rpdo_) pdo.constant = pdo.data;
}

ProcessData::Taken ProcessData::take(int number, const image::CanFrame& frame) noexcept {
  const auto i = static_cast<std::size_t>(number - 1);
  if (i >= received_.size() || tpdo_bytes_[i] == 0 || frame.remote) return Taken::not_used;
  if (frame.length < tpdo_bytes_[i]) return Taken::too_short;
  const std::uint32_t beyond = 8 * (kPdoBytes - tpdo_bytes_[i]);
  received_[i] = load_le(std::span(frame.data).first(kPdoBytes)) << beyond >> beyond;
  fresh_[i] = true;
  return Taken::stored;
}

void ProcessData::clear() noexcept {
  received_ = {};
  fresh_ = {};
  for (Rpdo& pdo : rpdo_) {
    pdo.data = pdo.constant;
    pdo.ever_sent = pdo.held = false;
  }
}

bool ProcessData::due(int number, NodeId node, std::int64_t cycle, image::Nanoseconds now) const noexcept {
  const Rpdo& pdo = rpdo_[static_cast<std::size_t>(number - 1)];
  if (pdo.bytes == 0 || pdo.held) return false;
  if (pdo.type == 0 || pdo.type > kLastSyncType) {
    if (pdo.ever_sent && pdo.data == pdo.sent && now - pdo.sent_ns < pdo.refresh_ns) return false;
  } else if (pdo.type > 1 && (cycle + node) % pdo.type != 0) {
    return false;
  }
  return true;
}

image::CanFrame ProcessData::frame(int number, NodeId node) const noexcept {
  const Rpdo& pdo = rpdo_[static_cast<std::size_t>(number - 1)];
  image::CanFrame out;
  out.id = cob::rpdo(number, node);
  out.length = pdo.bytes;
  store_le(pdo.data, std::span(out.data).first(kPdoBytes));
  return out;
}

image::CanFrame ProcessData::request(int number, NodeId node) const noexcept {
  image::CanFrame out;
  out.id = cob::tpdo(number, node);
  out.length = tpdo_bytes(number);
  out.remote = true;
  return out;
}

void ProcessData::sent(int number, image::Nanoseconds now) noexcept {
  Rpdo& pdo = rpdo_[static_cast<std::size_t>(number - 1)];
  pdo.sent = pdo.data;
  pdo.ever_sent = true;
  pdo.sent_ns = now;
}

}  // namespace servogate::canopen
