// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <span>
#include <string>

#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::canopen {

/// The rows of the alarms of buses and their nodes.
std::span<const image::AlarmRow> master_alarm_rows();

/// Their words: why a start-up failed, which frame somebody else sent, by what object. Not real-time safe.
class MasterAlarmWords final : public image::AlarmWords {
 public:
  /// The software version that the configuration expects of a node; empty: any.
  using Expected = std::function<std::string(const image::PartPlace&)>;

  MasterAlarmWords() = default;
  explicit MasterAlarmWords(Expected expected) : expected_(std::move(expected)) {}
  void arguments(const image::AlarmRecord& record, const image::AlarmNames& names, text::Language language,
                 image::AlarmArguments& out) const override;
  std::vector<image::AlarmFact> facts(const image::AlarmRecord& record) const override;

 private:
  std::string boot_words(const image::AlarmRecord& record, text::Language language) const;

  Expected expected_;
};

}  // namespace servogate::canopen
