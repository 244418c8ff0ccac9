// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "report/report.hpp"

namespace servogate::gateway {

/// Alarm records in words, the same for `status`, `alarms`, `run` and the report: each first fault, and
/// behind it what followed from it while the machine reacted (AlarmEntry::consequence). Not for the cycle.
std::vector<report::AlarmEntry> alarm_entries(Control& control, std::span<const image::AlarmRecord> records,
                                              text::Language language);

}  // namespace servogate::gateway
