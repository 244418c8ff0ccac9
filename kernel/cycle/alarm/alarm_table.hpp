// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/axis/axis_alarms.hpp"

namespace servogate::cycle {

/// Numbers of the alarms raised by buses, I/O, program, PLC and the cycle itself. Those of axes and spindles
/// (1000) and of drives as the axis sees them (2001-2004) are in kernel/axis/axis_alarms.hpp.
namespace alarm {
using image::AlarmNumber;

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

inline constexpr AlarmNumber kSourceStale = 3001;
inline constexpr AlarmNumber kSourceBad = 3002;

inline constexpr AlarmNumber kProgramError = 4001;
inline constexpr AlarmNumber kUnknownM = 4002;
inline constexpr AlarmNumber kMAckTimeout = 4003;
inline constexpr AlarmNumber kSAckTimeout = 4004;
inline constexpr AlarmNumber kTAckTimeout = 4005;
inline constexpr AlarmNumber kHAckTimeout = 4006;
inline constexpr AlarmNumber kStarved = 4007;
inline constexpr AlarmNumber kWriteRefused = 4009;
inline constexpr AlarmNumber kAxisNotReady = 4010;
inline constexpr AlarmNumber kSetpointLimit = 4011;
inline constexpr AlarmNumber kProgramWarning = 4012;

inline constexpr AlarmNumber kExternalAlarm = 5001;
inline constexpr AlarmNumber kPlcBudget = 5002;
inline constexpr AlarmNumber kPlcFault = 5003;
inline constexpr AlarmNumber kPlcHeld = 5004;
inline constexpr AlarmNumber kPlcWatchdog = 5005;

inline constexpr AlarmNumber kEmergencyStop = 6001;
inline constexpr AlarmNumber kOverrunLimit = 6002;
inline constexpr AlarmNumber kOperatorQuickStop = 6003;
inline constexpr AlarmNumber kRequestsLost = 6004;
inline constexpr AlarmNumber kGuardForced = 6005;
inline constexpr AlarmNumber kStateFellBack = 6006;
inline constexpr AlarmNumber kRecordBroken = 6007;
}  // namespace alarm

/// When an alarm may go.
enum class ResetCondition : std::uint8_t {
  reset,       ///< the operator's reset is enough
  cause_gone,  ///< reset, after the cause has gone
  by_itself,  ///< a warning that goes with its cause: one of a program with the start of the next one, one of
              ///< a homing with the next one that reaches its end
};

/// One kind of alarm. Texts have the placeholders {0} axis, {1} value, {2} limit, {3} node or segment or
/// source, {4} status word in words, {5} error code in words, {6} and {7} detail1 and detail2, {8} object,
/// {9} file and line of the block ("bracket.nc:12"; of the PLC: the number of its line).
struct AlarmRow {
  image::AlarmNumber number = 0;
  image::Reaction reaction = image::Reaction::none;  ///< default; the machine file may ask for a stronger one
  ResetCondition reset = ResetCondition::reset;
  text::Entry text;  ///< what happened; its id is the alarm's name in documents and JSON
  std::string_view remedy_en;
  std::string_view remedy_ru;
};

/// The one table of all alarms, by rising number. real-time safe.
std::span<const AlarmRow> alarm_table() noexcept;
/// Row of a number, nullptr when there is none. real-time safe.
const AlarmRow* find_alarm(image::AlarmNumber number) noexcept;

/// The alarm says that a part of a device is gone: its cause lasts while that part, or one of the segment
/// that the record names, is not in the image. real-time safe.
bool is_of_part(image::AlarmNumber number) noexcept;

/// Words for reactions and reset conditions, for people. Not real-time safe.
std::string_view words(image::Reaction reaction, text::Language language);
std::string_view words(ResetCondition condition, text::Language language);

/// The manual page docs/alarms.md, whole. Not real-time safe.
std::string alarms_page();

}  // namespace servogate::cycle
