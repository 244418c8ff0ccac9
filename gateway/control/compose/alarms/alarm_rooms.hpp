// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/canopen/master/alarms/master_alarms.hpp"
#include "firmware_if/image/alarms/alarm_table.hpp"
#include "kernel/channel/alarms/program_alarms.hpp"
#include "plc/logic/alarms/logic_alarms.hpp"

namespace servogate::gateway {

/// The alarms of all rooms in one table. A room that raises alarms of its own is a line in alarm_rooms.cpp.
/// Not real-time safe; the table is.
class AlarmRooms {
 public:
  /// Words that know no machine, for documents.
  AlarmRooms();
  /// Words that ask the machine.
  AlarmRooms(canopen::MasterAlarmWords bus, channel::ProgramAlarmWords program, plc::LogicAlarmWords logic);
  AlarmRooms(const AlarmRooms&) = delete;
  AlarmRooms& operator=(const AlarmRooms&) = delete;

  const image::AlarmTable& table() const noexcept { return table_; }

 private:
  canopen::MasterAlarmWords bus_;
  channel::ProgramAlarmWords program_;
  plc::LogicAlarmWords logic_;
  image::AlarmTable table_;
};

}  // namespace servogate::gateway
