// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/flow/output.hpp"

#include <string>

namespace servogate::program {

/// While it is a spindle the axis has no place to go to.
void Output::check_place(const Position& to) const {
  const auto axis = static_cast<std::size_t>(machine_.spindle_axis);
  if (state_.motion.spindle_is_axis || to[axis] == state_.motion.spindle_axis_place) return;
  fail(Fault::axis_is_spindle, column_of(block_, machine_.spindle_axis),
       {machine_.axes[axis].letter, std::to_string(machine_.spindle_axis_on_m)});
}

void Output::check_turning() const { refuse_turning(static_cast<int>(block_.body) + 1); }

void Output::check_angle() const {
  if (!machine_.spindle_angle) fail(Fault::spindle_no_angle, static_cast<int>(block_.body) + 1);
}

void Output::refuse_turning(int column) const {
  if (!state_.motion.spindle_is_axis) return;
  fail(Fault::spindle_is_axis, column,
       {machine_.axes[static_cast<std::size_t>(machine_.spindle_axis)].letter,
        std::to_string(machine_.spindle_axis_off_m)});
}

}  // namespace servogate::program
