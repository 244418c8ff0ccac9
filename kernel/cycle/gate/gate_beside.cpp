// SPDX-License-Identifier: Apache-2.0
// Requests beside a program that is held or waits for the operator.
#include <cmath>

#include "kernel/cycle/gate/decision.hpp"

namespace servogate::cycle::decision {

/// One axis at a time, so that the way back is the way out.
bool Decision::jog_beside(const Axis& a) noexcept {
  if (c_.beside.functions) return refuse(Refusal::function_runs);
  if (c_.beside.returns) return refuse(Refusal::axis_moves, c_.beside.axis);
  for (const Axis& b : c_.axes)
    if (&b != &a && !b.config().auxiliary && !b.geared() && b.process() == a.process() && b.moving())
      return refuse(Refusal::axis_moves, b.index());
  const bool another_leg = c_.beside.axis != a.index();
  return !(another_leg && c_.beside.full) || refuse(Refusal::way_back_full, c_.beside.axis);
}

/// Beside a held program: nothing that belongs to it is on its way.
bool Decision::process_stands() noexcept {
  if (!busy(state(r_.process))) return refuse(Refusal::program_does_not_run, -1, r_.process);
  if ((c_.stopping >> r_.process & 1u) != 0) return under_way(r_.process);
  if (!c_.beside.possible) return refuse(Refusal::program_not_held, -1, r_.process);
  if (c_.beside.returns) return refuse(Refusal::axis_moves, c_.beside.axis);
  for (const Axis& a : c_.axes)
    if (of_process(a) && a.moving()) return refuse(Refusal::axis_moves, a.index());
  return no_homing() && not_held_by_another();
}

/// The axes may go along the way that they came.
bool Decision::along_path() noexcept {
  if (r_.velocity < 0.0 || !std::isfinite(r_.velocity)) return refuse(Refusal::bad_value, -1, r_.velocity);
  if (!no_alarm(Reaction::stop_on_path) || !process_stands()) return false;
  if (c_.beside.functions) return refuse(Refusal::function_runs);
  for (const Axis& a : c_.axes)
    if (of_process(a) && !a.asleep() && (!ready(a) || !free(a))) return false;
  return true;
}

bool Decision::reposition() noexcept {
  return along_path() && (c_.beside.away || c_.beside.retraced || refuse(Refusal::on_path));
}

bool Decision::retrace() noexcept {
  if (!(r_.value > 0.0) && r_.index == 0) return refuse(Refusal::bad_value, -1, r_.value);
  if (!along_path()) return false;
  return !c_.beside.away || refuse(Refusal::off_path, c_.beside.axis, c_.beside.distance);
}

bool Decision::function() noexcept {
  if (r_.index >= static_cast<std::uint32_t>(image::kFunctions))
    return refuse(Refusal::bad_value, -1, r_.index, image::kFunctions - 1);
  if (r_.value < 0.0) return refuse(Refusal::bad_value, -1, r_.value);
  if (!no_alarm(Reaction::stop_at_block_end) || !process_stands()) return false;
  return !c_.beside.functions_full || refuse(Refusal::function_runs);
}

/// Choosing it moves nothing: the path goes by its speed, which is 0 while it stands.
bool Decision::path_wheel() noexcept {
  if (r_.index >= static_cast<std::uint32_t>(image::kWheelNews))
    return refuse(Refusal::bad_value, -1, r_.index, image::kWheelNews - 1);
  const bool chooses = r_.index == static_cast<std::uint32_t>(image::WheelNews::choose);
  if (!chooses && r_.asker != Asker::pendant)
    return refuse(Refusal::asker_may_not, -1, static_cast<double>(r_.kind));
  return c_.path_wheel || refuse(Refusal::no_path_wheel);
}

/// What the rest of the program counts on.
bool Decision::as_it_was_held() noexcept {
  const Beside& b = c_.beside;
  if (b.functions) return refuse(Refusal::function_runs);
  if (b.away) return refuse(Refusal::off_path, b.axis, b.distance);
  if (b.returns) return refuse(Refusal::axis_moves, b.axis);
  if (b.retraced) return refuse(Refusal::retraced, -1, b.retraced_mm);
  if (b.tool >= 0) return refuse(Refusal::tool_differs, -1, b.tool);
  return b.spindle < 0 || refuse(Refusal::spindle_differs, -1, b.spindle_rpm);
}

}  // namespace servogate::cycle::decision
