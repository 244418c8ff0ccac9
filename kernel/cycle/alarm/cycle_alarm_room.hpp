// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::cycle {

/// The alarms that the cycle raises by itself, with their words. Not real-time safe.
const image::AlarmRoom& alarm_room();

}  // namespace servogate::cycle
