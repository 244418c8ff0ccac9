// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarms/alarm_text.hpp"
#include "gateway/control/compose/alarms/alarm_rooms.hpp"

namespace servogate::tests {

/// The alarms of all rooms, with words that know no machine.
inline const image::AlarmTable& alarm_table() {
  static const gateway::AlarmRooms rooms;
  return rooms.table();
}

inline image::AlarmNames alarm_names() {
  image::AlarmNames names;
  names.table = &alarm_table();
  return names;
}

}  // namespace servogate::tests
