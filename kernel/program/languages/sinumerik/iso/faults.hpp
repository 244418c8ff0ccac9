// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/faults/texts.hpp"

namespace servogate::program::sinumerik::iso {

/// What the ISO dialect alone has to say, with the manual's alarm numbers where it has some (specification
/// 24).
enum class Wrong {
  feed_zero,
  letter_missing,
  letter_range,
  program_digits,
  macro_twice,
  switch_alone,
  reference_position,
  reference_number,
  scaled,
  dwell_time,
  dwell_spindle,
  plane_parallel,
  rotation_vector,
  offset_missing,
  offset_number,
  contour_block,
  contour_order,
  contour_word,
  contour_last,
  contour_pocket,
  chamfer_zero,
  step,
  passes,
  thread_lead,
  thread_ends,
  corner_open,
  angle_none,
  siemens_word,
  compensated,
  axis_alone,
  alone,
  target_missing,
  macro_argument,
  setting_choice,
  contour_mdi,
  user_alarm,
  circle_plane,
  floating_missing,
  overrun_missing,
  turret,
  macro_value,
  plane_exchange,
  system_variable,
  beside_call,
  rotary_way,
  rotation_axis,
  start_inside,
  hole_depth,
  polygon_spindle,
  polygon_speed,
  polygon_limit,
};

std::span<const text::Entry> messages();
const text::Entry& entry(Wrong wrong);

[[noreturn]] inline void fail(Wrong wrong, int column, std::vector<std::string> arguments = {}) {
  throw ProgramError{&entry(wrong), column, std::move(arguments)};
}

}  // namespace servogate::program::sinumerik::iso
