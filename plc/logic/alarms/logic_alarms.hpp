// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>

#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::plc {

/// The rows of the alarms of a PLC program that was stopped.
std::span<const image::AlarmRow> logic_alarm_rows();

/// Their words. Not real-time safe.
class LogicAlarmWords final : public image::AlarmWords {
 public:
  /// What stopped the program, with task, file and line (Logic::fault_words()); may be empty.
  using Fault = std::function<std::string(const image::AlarmRecord&, text::Language)>;

  LogicAlarmWords() = default;
  explicit LogicAlarmWords(Fault fault) : fault_(std::move(fault)) {}
  void arguments(const image::AlarmRecord& record, const image::AlarmNames& names, text::Language language,
                 image::AlarmArguments& out) const override;

 private:
  Fault fault_;
};

}  // namespace servogate::plc
