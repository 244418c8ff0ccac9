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
