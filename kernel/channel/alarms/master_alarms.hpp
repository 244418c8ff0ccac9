// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/alarm.hpp"

/// Numbers of the alarms of motions by the spindle's angle, by a handwheel along the path, of electronic
/// gears, and of probes; their texts stand in program_rows.hpp.
namespace servogate::channel::alarm {

using image::AlarmNumber;

inline constexpr AlarmNumber kThreadMasterLost = 4101;
inline constexpr AlarmNumber kThreadMasterTurned = 4102;
inline constexpr AlarmNumber kThreadWindow = 4103;
inline constexpr AlarmNumber kThreadTooFast = 4104;
inline constexpr AlarmNumber kThreadTooShort = 4105;
inline constexpr AlarmNumber kThreadHeld = 4106;
inline constexpr AlarmNumber kThreadNoEncoder = 4107;
inline constexpr AlarmNumber kThreadSpindleStands = 4108;
inline constexpr AlarmNumber kTapTooDeep = 4109;
inline constexpr AlarmNumber kTapNoTurn = 4110;
inline constexpr AlarmNumber kProbeNone = 4111;
inline constexpr AlarmNumber kProbeStuck = 4112;
inline constexpr AlarmNumber kProbeMissed = 4113;
inline constexpr AlarmNumber kProbeInRapid = 4114;
inline constexpr AlarmNumber kProbeNotFree = 4115;
inline constexpr AlarmNumber kProbeNotLatched = 4116;
inline constexpr AlarmNumber kThreadStarved = 4117;
inline constexpr AlarmNumber kPathWheelLost = 4118;
inline constexpr AlarmNumber kPathWheelFast = 4119;
inline constexpr AlarmNumber kGearedAxis = 4120;

}  // namespace servogate::channel::alarm
