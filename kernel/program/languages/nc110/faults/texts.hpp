// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/faults/texts.hpp"

namespace servogate::program::nc110 {

/// What only NC-110 has to say, in the ranges of program::Fault.
enum class Wrong : std::uint8_t {
  after_bracket,
  place_bad,
  text_for_number,
  number_for_text,
  text_compare,
  repeat_count,
  program_name,
  part_nested,
  part_reversed,
  jump_out_of_part,
  code_unknown,
  operand_missing,
  operand_many,
  operand_axis,
  operand_axis_twice,
  operand_axes_many,
  text_long,
  origin_range,
  plane_in_profile,
  dwell_range,
  wait_form,
  wait_format,
  wait_bit,
  limits_pair,
  cycle_active,
  cycle_motion,
  cycle_depth,
  cycle_hole,
  cycle_step_missing,
  function_in_profile,
  tool_form,
  dwell_no_speed,
  dwell_surface_speed,
  dwell_zero,
  element_number,
  element_form,
  element_axis,
  element_missing,
  element_none,
  element_incremental,
  element_item,
  element_word,
  profile_none,
  profile_point,
  profile_empty,
  profile_end,
  profile_apart,
  profile_off,
  profile_backwards,
  profile_open,
  timer_index,
  timer_rapid,
  sync_missing,
  zone_number,
  zone_missing,
  corrector_number,
  probe_parameters,
  thread_lead,
  thread_ends,
  thread_alias,
  tap_no_speed,
  spline_motion,
  spline_plane,
  spline_ends,
  spline_direction,
  spline_long,
  spline_double,
  spline_function,
  probe_result,
  probe_no_parameters,
  probe_no_way,
  probe_axes,
  probe_radius,
  graphics,
  process_number,
  process_own,
  virtual_mode,
  virtual_form,
  virtual_axis,
  virtual_zero,
  virtual_radius_value,
  parallel_digits,
  skew_angle,
  configuration,
  analogue_output,
  record_file,
  keyboard,
  screen,
  tap_short,
  rest_form,
  rest_axis,
  read_only,
  window_virtual,
  window_wide,
  record_field,
  record_fields,
  record_access,
  record_structure,
  record_count,
};

/// All texts, in the order of Wrong.
std::span<const text::Entry> messages();
const text::Entry& entry(Wrong wrong);

[[noreturn]] inline void fail(Wrong wrong, int column, std::vector<std::string> arguments = {}) {
  throw ProgramError{&entry(wrong), column, std::move(arguments)};
}

}  // namespace servogate::program::nc110
