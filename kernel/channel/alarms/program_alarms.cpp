// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/alarms/program_alarms.hpp"

#include "kernel/channel/alarms/program_rows.hpp"

namespace servogate::channel {

namespace {

/// Found by the interpreter, which says the file itself.
bool is_finding(const image::AlarmRecord& r) {
  return r.number == image::alarm::kProgramError || r.number == image::alarm::kProgramWarning;
}

}  // namespace

std::span<const image::AlarmRow> program_alarm_rows() { return kProgramRows; }

/// "bracket.nc:12" of a block.
void ProgramAlarmWords::arguments(const image::AlarmRecord& r, const image::AlarmNames&,
                                  text::Language language, image::AlarmArguments& out) const {
  if (r.process < 0) return;
  const std::string file = !is_finding(r) && file_ ? file_(r.process, r.run, r.file) : std::string();
  const std::string line = std::to_string(r.line);
  out[9] =
      !file.empty() ? file + ":" + line : (language == text::Language::russian ? "строка " : "line ") + line;
}

std::string ProgramAlarmWords::appendix(const image::AlarmRecord& r, text::Language language) const {
  return is_finding(r) && found_ ? found_(r.process, static_cast<int>(r.value), language) : std::string();
}

}  // namespace servogate::channel
