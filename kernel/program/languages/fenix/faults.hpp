// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/faults/texts.hpp"

namespace servogate::program::fenix {

/// What Fenix alone has to say, with the guide's numbers where it has some (specification 23).
enum class Wrong {
  over_defined,
  line_axis,
  line_angle,
  arc_angle,
  thread_equal,
  thread_speed,
  thread_feed,
  cutting_limits,
  least_speed,
  argument_missing,
  argument_range,
  arguments,
  step,
  passes,
  cycle_axis,
  contour_missing,
  argument_negative,
  argument_choice,
  argument_slope,
  argument_angle,
  spindle_free,
  spindle_speed,
  subprogram_open,
};

std::span<const text::Entry> messages();
const text::Entry& entry(Wrong wrong);

[[noreturn]] inline void fail(Wrong wrong, int column, std::vector<std::string> arguments = {}) {
  throw ProgramError{&entry(wrong), column, std::move(arguments)};
}

}  // namespace servogate::program::fenix
