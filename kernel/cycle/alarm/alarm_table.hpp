// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/alarm_numbers.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/axis/axis_alarms.hpp"

namespace servogate::cycle {

namespace alarm = image::alarm;

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

/// The one table of all alarms, by rising number: the tables of all origins (rows/) together. real-time safe.
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
