// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/foreign_master.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kMayMove{
    "can.may-move", "{0} can move a drive; if that is intended, add --i-may-move",
    "{0} может привести привод в движение; если это и требуется, добавьте --i-may-move"};
const text::Entry kInUse{
    "can.in-use", "{0} is refused: another master controls this bus (its frame {1} was seen within {2} s)",
    "{0} не выполняется: этой шиной управляет другой ведущий (за {2} с получен его кадр {1})"};

const text::Entry kNotRead{
    "can.not-read",
    "another master controls this bus (its frame {0} was seen within {1} s), and it is not a control of this "
    "user. Requests sent from here would get mixed up with its own. Read through that master, or stop it "
    "first; --anyway reads regardless",
    "этой шиной управляет другой ведущий (за {1} с получен его кадр {0}), и это не управление, запущенное "
    "этим пользователем. Запросы отсюда перемешались бы с его запросами. Читайте через него или сначала "
    "остановите его; с --anyway чтение выполняется всё равно"};

}  // namespace

std::optional<image::CanFrame> foreign_master(ToolBus& bus, image::Nanoseconds listening) {
  std::optional<image::CanFrame> found;
  bus.listen(listening, [&](const image::CanFrame& frame) {
    if (canopen::sent_by_masters(frame)) found = frame;
    return found.has_value();
  });
  return found;
}

bool can_move(std::uint16_t index) {
  constexpr std::uint16_t kObjects[] = {0x6040, 0x6042, 0x6060, 0x6071, 0x607A, 0x60B0,
                                        0x60B1, 0x60B2, 0x60C1, 0x60FE, 0x60FF};
  if (index == 0x1F82 || index == 0x1F51) return true;
  if (index < 0x6000 || index >= 0xA000) return false;
  const auto own = static_cast<std::uint16_t>(0x6000 + (index - 0x6000) % 0x800);
  // Outputs of a CiA 401 module, digital and analogue, with their polarity: valves and brakes hang on them.
  if ((own >= 0x6200 && own < 0x6400) || (own >= 0x6410 && own < 0x6420)) return true;
  return std::find(std::begin(kObjects), std::end(kObjects), own) != std::end(kObjects);
}

bool takes_energy_away(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data) {
  constexpr std::uint8_t kEnableVoltage = 1 << 1, kNoQuickStop = 1 << 2, kFaultReset = 1 << 7;
  const bool controlword = index >= 0x6000 && index < 0xA000 && (index - 0x6000) % 0x800 == 0x40;
  if (!controlword || subindex != 0 || data.size() != 2 || (data[0] & kFaultReset) != 0) return false;
  return (data[0] & kEnableVoltage) == 0 || (data[0] & kNoQuickStop) == 0;
}

int must_be_idle(ToolBus& bus, const std::string& what, const CanopenBusOptions& options) {
  const double listen_s = options.listen_s.value_or(kSilenceBeforeWriting_s);
  const auto frame = foreign_master(bus, std::llround(listen_s * 1e9));
  if (!frame) return kDone;
  complain(kInUse, {what, canopen::frame_words(*frame), text::number(listen_s)});
  return kAlarm;
}

int may_read(ToolBus& bus, const CanopenBusOptions& options) {
  if (options.anyway) return kDone;
  const double listen_s = options.listen_s.value_or(kSilenceBeforeReading_s);
  const auto frame = foreign_master(bus, std::llround(listen_s * 1e9));
  if (!frame) return kDone;
  complain(kNotRead, {canopen::frame_words(*frame), text::number(listen_s)});
  return kAlarm;
}

int may_move(ToolBus& bus, const std::string& what, const CanopenBusOptions& options) {
  if (!options.may_move) {
    complain(kMayMove, {what});
    return kWrongUse;
  }
  return must_be_idle(bus, what, options);
}

}  // namespace servogate::gateway::command
