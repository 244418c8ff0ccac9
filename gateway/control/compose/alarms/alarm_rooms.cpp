// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/alarms/alarm_rooms.hpp"

#include "firmware_if/board/master/board_alarms.hpp"
#include "kernel/axis/alarms/axis_alarm_room.hpp"
#include "kernel/cycle/alarm/cycle_alarm_room.hpp"

namespace servogate::gateway {

AlarmRooms::AlarmRooms() : AlarmRooms({}, {}, {}) {}

AlarmRooms::AlarmRooms(canopen::MasterAlarmWords bus, channel::ProgramAlarmWords program,
                       plc::LogicAlarmWords logic)
    : bus_(std::move(bus)),
      program_(std::move(program)),
      logic_(std::move(logic)),
      table_{axis::alarm_room(),
             {canopen::master_alarm_rows(), &bus_},
             {channel::program_alarm_rows(), &program_},
             {plc::logic_alarm_rows(), &logic_},
             cycle::alarm_room(),
             board::alarm_room()} {}

}  // namespace servogate::gateway
