// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/boring.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

constexpr int kMostPasses = 10'000;

/// Feeds and speeds of a hole; those of before come back with it.
class Conditions {
 public:
  Conditions(Execution& run, const Boring& hole)
      : run_(run),
        feed_(run.state().motion.feed),
        speed_(run.state().modes.speed),
        mode_(run.state().motion.spindle) {
    if (hole.feed > 0.0) run.state().motion.feed = hole.feed;
    turn(hole.rpm);
  }
  Conditions(const Conditions&) = delete;
  Conditions& operator=(const Conditions&) = delete;
  void feed(double value) { run_.state().motion.feed = value; }
  void turn(double rpm) {
    if (rpm <= 0.0 || rpm == run_.state().modes.speed) return;
    run_.state().modes.speed = rpm;
    run_.motion().turn_spindle(run_.state().motion.spindle);
  }
  void stop() {
    if (mode_ != SpindleMode::stop) run_.motion().turn_spindle(SpindleMode::stop);
  }
  void restore() {
    run_.state().motion.feed = feed_;
    const bool changed = run_.state().modes.speed != speed_ || run_.state().motion.spindle != mode_;
    run_.state().modes.speed = speed_;
    if (changed) run_.motion().turn_spindle(mode_);
  }

 private:
  Execution& run_;
  double feed_, speed_;
  SpindleMode mode_;
};

void dwell(Execution& run, double seconds) {
  if (seconds > 0.0) run.motion().dwell(seconds);
}

/// The rest behind the last whole pass is one of its own; without one the last whole pass is the last.
void break_chips(Execution& run, const Boring& hole, double down) {
  const ChipBreaking& chips = hole.chips;
  double bottom = hole.approach + down * (hole.first > 0.0 ? hole.first : chips.pass);
  for (int pass = 0; (hole.depth - bottom) * down > 1e-9; ++pass, bottom += down * chips.pass) {
    if (pass == kMostPasses) fail(Fault::cycle_pecks, 0, {hole.name, std::to_string(kMostPasses)});
    run.motion().go(hole.axis, bottom, false);
    dwell(run, chips.dwell_s);
    run.motion().go(hole.axis, bottom - down * chips.back, true);
  }
  run.motion().go(hole.axis, hole.depth, false);
  if (!chips.last) return;
  dwell(run, chips.dwell_s);
  run.motion().go(hole.axis, hole.depth - down * chips.back, true);
}

void leave(Execution& run, Conditions& conditions, const Boring& hole, double to) {
  if (hole.stops) conditions.stop();
  if (hole.shift_axis >= 0 && hole.shift != 0.0) {
    const double at = run.state().frames.programmed[static_cast<std::size_t>(hole.shift_axis)];
    run.motion().go(hole.shift_axis, at + hole.shift, false);
  }
  if (!hole.stops) conditions.turn(hole.back_rpm);
  if (hole.back_feed > 0.0) conditions.feed(hole.back_feed);
  run.motion().go(hole.axis, to, hole.back_feed <= 0.0);
}

/// Back over the hole, as it was before the tool left the wall.
void enter(Execution& run, const Boring& hole, double across, double to) {
  if (hole.shift_axis >= 0) run.motion().go(hole.shift_axis, across, true);
  if (hole.stops) run.motion().turn_spindle(run.state().motion.spindle);
  run.motion().go(hole.axis, to, true);
}

}  // namespace

void bore(Execution& run, const Boring& hole) {
  const double down = hole.depth < hole.approach ? -1.0 : 1.0;
  if (!hole.only_down) run.motion().go(hole.axis, hole.approach, true);
  const SpindleMode mode = run.state().motion.spindle;
  const double feed = hole.feed > 0.0 ? hole.feed : run.state().motion.feed;
  const double rpm = hole.rpm > 0.0 ? hole.rpm : run.state().modes.speed;
  const double across =
      hole.shift_axis >= 0 ? run.state().frames.programmed[static_cast<std::size_t>(hole.shift_axis)] : 0.0;
  Conditions conditions(run, hole);
  if (hole.next <= 0.0) {
    hole.chips.on ? break_chips(run, hole, down) : run.motion().go(hole.axis, hole.depth, false);
    dwell(run, hole.dwell_bottom_s);
    if (!hole.only_down) leave(run, conditions, hole, hole.retreat);
    return conditions.restore();
  }
  double bottom = hole.approach + down * hole.first;
  for (int pass = 0;; ++pass, bottom += down * hole.next) {
    if (pass == kMostPasses) fail(Fault::cycle_pecks, 0, {hole.name, std::to_string(kMostPasses)});
    const bool last = (hole.depth - bottom) * down < 1e-9;
    if (last) bottom = hole.depth;
    run.motion().go(hole.axis, bottom, false);
    dwell(run, last ? hole.dwell_bottom_s : hole.dwell_pass_s);
    leave(run, conditions, hole, last ? hole.retreat : hole.approach);
    if (last) break;
    dwell(run, hole.dwell_out_s);
    run.state().motion.spindle = mode;
    enter(run, hole, across, bottom - down * std::min(hole.reentry, std::abs(bottom - hole.approach)));
    conditions.feed(feed);
    conditions.turn(rpm);
  }
  conditions.restore();
}

}  // namespace servogate::program
