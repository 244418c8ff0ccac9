// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::program {

/// Everything the program room has to say to a person. P1xx text of a block, P2xx words, P3xx values, P4xx
/// packets, P5xx flow, P6xx three-letter codes and frames, P7xx motion, P8xx functions, P9xx limits of this
/// version.
enum class Fault : std::uint8_t {
  block_too_long,
  label_unclosed,
  label_bad,
  prefix_order,
  number_missing_block,
  label_twice,
  trailing_comment,
  block_number_long,
  string_unclosed,
  bracket_unclosed,
  cyrillic,
  lone_return,
  unknown_character,
  unknown_word,
  axis_missing,
  word_twice,
  too_many_words,
  out_of_range,
  whole_number,
  parameter_type,
  parameter_number_missing,
  number_bad,
  g_unknown,
  g_conflict,
  g_after_operand,
  m_too_many,
  word_without_function,
  expected,
  g_with_parameter,
  value_missing,
  arguments_many,
  expression_expected,
  closing_expected,
  function_unknown,
  comma_expected,
  division_by_zero,
  domain,
  parameter_absent,
  parameter_range,
  characters_as_number,
  equals_expected,
  variable_unknown,
  not_a_number,
  parameter_unset,
  place_outside,
  place_range,
  text_too_long,
  place_protected,
  label_missing,
  repeat_depth,
  repeat_without_end,
  end_without_repeat,
  call_depth,
  program_missing,
  end_in_subprogram,
  endless,
  block_limit,
  start_missing,
  origin_missing,
  origin_without_axis,
  scale_zero,
  plane_missing,
  variable_range,
  travel,
  field,
  feed_missing,
  feed_inverse,
  block_time,
  not_congruent,
  arc_words,
  arc_centre_pair,
  arc_both,
  arc_full_by_radius,
  arc_too_small,
  arc_zero,
  arc_scaled,
  helix_pitch,
  helix_axis,
  helix_mismatch,
  helix_long,
  machine_zero_arc,
  cycle_step,
  cycle_pecks,
  feed_missing_more,
  m_end_twice,
  spindle_conflict,
  no_spindle,
  speed_above,
  speed_below,
  surface_speed_axis,
  tool_outside,
  corrector_missing,
  feed_above,
  more_places,
  spindle_stands,
  no_speed,
  no_cutting_speed,
  cycle_no_depth,
  cycle_passes_depth,
  cycle_return_below,
  not_executed,
  power_on_bad,
  dialect_unknown,
  power_on_for_block,
  power_on_excluded,
  power_on_twice,
  findings_many,
  tool_worn_out,
  contour_entry_arc,
  contour_exit_arc,
  contour_side,
  contour_inner_arc,
  contour_reversed,
  contour_no_joint,
  contour_bottleneck,
  contour_behind,
  contour_excludes,
  contour_waits,
  corner_place,
  corner_none,
  chamfer_lines,
  chamfer_long,
  factor_axis,
  contour_open,
  zone,
  no_radius,
  power_on_begins,
  mark_motion,
  mark_spindle,
  axis_follows,
  virtual_motion,
  virtual_feed,
  virtual_radius,
  index_count,
  own_code_bad,
  own_code_taken,
  own_code_word,
  own_code_alone,
  cycle_corner,
  skip_level,
  axis_is_spindle,
  spindle_is_axis,
  spindle_axis_coupled,
  spindle_no_angle,
};

/// All texts, in the order of Fault.
std::span<const text::Entry> messages();
/// The text of one message.
const text::Entry& entry(Fault fault);

/// First arguments of Fault::travel and Fault::field: a diameter axis is named so, with its places as
/// diameters. `value`, `limit`: machine coordinates, a diameter axis' as radius.
std::vector<std::string> outside_arguments(const std::string& letter, bool diameter, double value,
                                           double limit);

/// What was written, with the capitals A to Z that it would have.
std::string in_capitals(std::string_view written);
/// Last argument of Fault::unknown_word and its like: that words have capital letters, where some of
/// `written` are small and with capitals it is `known`; otherwise nothing.
std::string capitals_hint(std::string_view written, bool known);

/// Thrown inside of this room only, caught in Interpreter: the block cannot be read or executed. `column`
/// counts from 1.
struct ProgramError {
  const text::Entry* entry;
  int column = 0;
  std::vector<std::string> arguments;
  int line = 0;  ///< from 1; 0: that of the block which is executed
};
[[noreturn]] inline void fail(Fault fault, int column, std::vector<std::string> arguments = {}) {
  throw ProgramError{&entry(fault), column, std::move(arguments)};
}

}  // namespace servogate::program
