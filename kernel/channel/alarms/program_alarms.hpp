// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>

#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::channel {

/// The rows of the alarms of programs.
std::span<const image::AlarmRow> program_alarm_rows();

/// Their words, which name file and line of the block and what the interpreter found. Not real-time safe.
class ProgramAlarmWords final : public image::AlarmWords {
 public:
  /// Path of a file of a run as people open it (ProcessStatus::run, ::file); may be empty.
  using File = std::function<std::string(int process, std::uint32_t run, int file)>;
  /// What a program's interpreter found (its number in AlarmRecord::value), with file, line and column; may
  /// be empty.
  using Found = std::function<std::string(int process, int number, text::Language)>;

  ProgramAlarmWords() = default;
  ProgramAlarmWords(File file, Found found) : file_(std::move(file)), found_(std::move(found)) {}
  void arguments(const image::AlarmRecord& record, const image::AlarmNames& names, text::Language language,
                 image::AlarmArguments& out) const override;
  std::string appendix(const image::AlarmRecord& record, text::Language language) const override;

 private:
  File file_;
  Found found_;
};

}  // namespace servogate::channel
