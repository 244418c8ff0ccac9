// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/canned.hpp"

#include <algorithm>
#include <string>

namespace servogate::program {
namespace {

constexpr int kMaxPecks = 10'000;

void check_levels(Execution& run, Cycle& cycle) {
  const double from = run.state().frames.programmed[static_cast<std::size_t>(cycle.axis)];
  const std::string depth = text::number(cycle.depth, 4), approach = text::number(cycle.approach, 4);
  const double down = cycle.depth - cycle.approach;
  if (down == 0.0)
    run.capability().warn(cycle.levels_at, Fault::cycle_no_depth, {cycle.name, depth, approach});
  else if ((cycle.depth - from) * (cycle.approach - cycle.depth) > 0.0)
    run.capability().warn(cycle.levels_at, Fault::cycle_passes_depth, {cycle.name, depth, approach});
  else if ((cycle.retreat - cycle.approach) * down > 0.0)
    run.capability().warn(cycle.levels_at, Fault::cycle_return_below,
                          {cycle.name, depth, text::number(cycle.retreat, 4), approach});
}

void go_down(Execution& run, const Cycle& cycle, double to) {
  if (cycle.lead > 0.0)
    run.motion().tap(cycle.axis, to, cycle.lead);
  else
    run.motion().go(cycle.axis, to, false);
  if (cycle.dwell_s > 0.0) run.motion().dwell(cycle.dwell_s);
}

/// The chip is broken, the tool stays in the hole.
void break_chips(Execution& run, const Cycle& cycle, double sign) {
  double bottom = cycle.approach;
  for (int pecks = 0; bottom != cycle.depth; ++pecks) {
    if (pecks == kMaxPecks) fail(Fault::cycle_pecks, 0, {cycle.name, std::to_string(kMaxPecks)});
    bottom += sign * cycle.step;
    if ((bottom - cycle.depth) * sign > -1e-9) bottom = cycle.depth;
    go_down(run, cycle, bottom);
  }
}

/// Out to the level of approach after each step; it re-enters a clearance above the last bottom, and the next
/// step is counted from there.
void remove_chips(Execution& run, const Cycle& cycle, double sign) {
  double from = cycle.approach, step = cycle.step;
  for (int pecks = 0;; ++pecks) {
    if (pecks == kMaxPecks) fail(Fault::cycle_pecks, 0, {cycle.name, std::to_string(kMaxPecks)});
    if (step <= cycle.clearance)
      fail(Fault::cycle_step, 0, {cycle.name, text::number(step, 4), text::number(cycle.clearance)});
    const double bottom = from + sign * step;
    if ((bottom - cycle.depth) * sign > -1e-9) return go_down(run, cycle, cycle.depth);
    go_down(run, cycle, bottom);
    run.motion().go(cycle.axis, cycle.approach, true);
    from += sign * (step - cycle.clearance);
    run.motion().go(cycle.axis, from, true);
    step = std::max(step * cycle.factor, cycle.min_step);
  }
}

SpindleMode reversed(SpindleMode mode) {
  return mode == SpindleMode::cw ? SpindleMode::ccw : mode == SpindleMode::ccw ? SpindleMode::cw : mode;
}

}  // namespace

void work_hole(Execution& run, Cycle& cycle) {
  check_levels(run, cycle);
  run.motion().go(cycle.axis, cycle.approach, true);
  const SpindleMode mode = run.state().motion.spindle;
  if (cycle.spindle_rests) run.motion().turn_spindle(mode);
  cycle.spindle_rests = false;
  const double sign = cycle.depth < cycle.approach ? -1.0 : 1.0;
  if (cycle.step == 0.0)
    go_down(run, cycle, cycle.depth);
  else
    cycle.factor != 0.0 ? remove_chips(run, cycle, sign) : break_chips(run, cycle, sign);
  const bool reverses = cycle.at_bottom == Cycle::Spindle::reverses;
  const bool by_turns = cycle.lead > 0.0;
  if (reverses) run.motion().turn_spindle(reversed(mode), by_turns ? cycle.back_share : 1.0);
  if (cycle.at_bottom == Cycle::Spindle::stops && mode != SpindleMode::stop) {
    run.motion().turn_spindle(SpindleMode::stop);
    run.state().motion.spindle = mode;
    cycle.spindle_rests = true;
  }
  if (by_turns)
    run.motion().tap(cycle.axis, cycle.approach, cycle.lead);
  else if (cycle.back_at_feed)
    run.motion().go(cycle.axis, cycle.approach, false, cycle.back_share);
  if (reverses) run.motion().turn_spindle(mode);
  run.motion().go(cycle.axis, cycle.retreat, true);
}

}  // namespace servogate::program
