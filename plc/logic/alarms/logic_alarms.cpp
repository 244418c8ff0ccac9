// SPDX-License-Identifier: Apache-2.0
#include "plc/logic/alarms/logic_alarms.hpp"

#include "plc/logic/alarms/logic_rows.hpp"

namespace servogate::plc {

std::span<const image::AlarmRow> logic_alarm_rows() { return kLogicRows; }

void LogicAlarmWords::arguments(const image::AlarmRecord& r, const image::AlarmNames&,
                                text::Language language, image::AlarmArguments& out) const {
  out[6] = fault_ ? fault_(r, language) : std::string();
  if (!out[6].empty()) return;
  const bool russian = language == text::Language::russian;
  out[6] = (russian ? "ошибка " : "error ") + text::number(r.value, 0) +
           (russian ? " в строке " : " in line ") + std::to_string(r.line);
}

}  // namespace servogate::plc
