// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_table.hpp"

namespace servogate::axis {

/// The alarms of axes, spindles and their drives, with their words. Not real-time safe.
const image::AlarmRoom& alarm_room();

}  // namespace servogate::axis
