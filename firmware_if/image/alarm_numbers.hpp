// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarm.hpp"

/// Numbers of the alarms that devices, programs, the PLC and the cycle itself raise; whoever notices a fault
/// names its number, and the room that raises it has its row (alarms/alarm_table.hpp). Those of axes and
/// spindles (1000) and of drives as the axis sees them (2001-2003) are in kernel/axis/alarms/axis_alarms.hpp.
namespace servogate::image::alarm {

inline constexpr AlarmNumber kPdoMissing = 2004;
inline constexpr AlarmNumber kNodeLost = 2010;
inline constexpr AlarmNumber kEmergencyMessage = 2011;
inline constexpr AlarmNumber kBusOff = 2012;
inline constexpr AlarmNumber kBusErrorPassive = 2013;
inline constexpr AlarmNumber kForeignFrame = 2014;
inline constexpr AlarmNumber kBootFailed = 2015;
inline constexpr AlarmNumber kBusSendOverflow = 2016;
inline constexpr AlarmNumber kBusDown = 2017;
inline constexpr AlarmNumber kNodeRestarted = 2018;
inline constexpr AlarmNumber kNodeLeft = 2019;
inline constexpr AlarmNumber kPdoShort = 2020;
inline constexpr AlarmNumber kErrorHistory = 2021;
inline constexpr AlarmNumber kNotInterpolating = 2022;
inline constexpr AlarmNumber kReportsLost = 2023;
inline constexpr AlarmNumber kForeignRequest = 2024;
inline constexpr AlarmNumber kLeadLost = 2025;

inline constexpr AlarmNumber kSourceStale = 3001;
inline constexpr AlarmNumber kSourceBad = 3002;
inline constexpr AlarmNumber kBoardRefused = 3003;

inline constexpr AlarmNumber kProgramError = 4001;
inline constexpr AlarmNumber kUnknownM = 4002;
inline constexpr AlarmNumber kMAckTimeout = 4003;
inline constexpr AlarmNumber kSAckTimeout = 4004;
inline constexpr AlarmNumber kTAckTimeout = 4005;
inline constexpr AlarmNumber kHAckTimeout = 4006;
inline constexpr AlarmNumber kStarved = 4007;
inline constexpr AlarmNumber kWriteRefused = 4009;
inline constexpr AlarmNumber kProgramWarning = 4012;

inline constexpr AlarmNumber kExternalAlarm = 5001;
inline constexpr AlarmNumber kPlcBudget = 5002;
inline constexpr AlarmNumber kPlcFault = 5003;
inline constexpr AlarmNumber kPlcHeld = 5004;
inline constexpr AlarmNumber kPlcWatchdog = 5005;

inline constexpr AlarmNumber kEmergencyStop = 6001;
inline constexpr AlarmNumber kOverrunLimit = 6002;
inline constexpr AlarmNumber kOperatorQuickStop = 6003;
inline constexpr AlarmNumber kGuardForced = 6005;
inline constexpr AlarmNumber kStateFellBack = 6006;
inline constexpr AlarmNumber kRecordBroken = 6007;

}  // namespace servogate::image::alarm
