// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "kernel/program/cycles/boring.hpp"
#include "kernel/program/cycles/tapping.hpp"
#include "kernel/program/languages/sinumerik/iso/holes.hpp"

/// G73, G74, G76, G81 to G87 and G89 of milling (specification 20.3, 20.4).
namespace servogate::program::sinumerik::iso {
namespace {

double one(const Execution& run) { return run.state().modes.unit == Function::inch ? 25.4 : 1.0; }

/// Retract that breaks chips.
double breaking(const Execution& run) {
  const double set = setting(run, "ZSFR1");
  return set > 0.0 ? set : one(run);
}

/// Where the tip leaves the wall: an axis and a sign, by ZSFI5 and the plane.
struct Direction {
  int axis;
  double sign;
};
Direction away(const Execution& run) {
  const FramesState& frames = run.state().frames;
  const int which = static_cast<int>(setting(run, "ZSFI5"));
  return {which <= 2 ? frames.axis1 : frames.axis2, which == 1 || which == 3 ? 1.0 : -1.0};
}

void shift(Execution& run, const Direction& to, double way) {
  if (way == 0.0) return;
  run.motion().go(to.axis, run.state().frames.programmed[at(to.axis)] + to.sign * way, true);
}

void orient(Execution& run) { run.motion().turn_spindle(SpindleMode::orient); }

void dwell(Execution& run, double seconds) {
  if (seconds > 0.0) run.motion().dwell(seconds);
}

/// The tip leaves the wall before the tool leaves the hole.
void fine_boring(Execution& run, const Hole& hole) {
  const SpindleMode turning = run.state().motion.spindle;
  const Direction to = away(run);
  run.motion().go(hole.axis, hole.level, true);
  run.motion().go(hole.axis, hole.depth, false);
  dwell(run, hole.dwell_s);
  orient(run);
  shift(run, to, hole.step);
  run.motion().go(hole.axis, hole.level, true);
  shift(run, to, -hole.step);
  if (turning != SpindleMode::stop) run.motion().turn_spindle(turning);
}

/// The tool goes through the hole beside its wall and cuts on the way up.
void back_boring(Execution& run, const Hole& hole) {
  const SpindleMode turning = run.state().motion.spindle;
  const Direction to = away(run);
  orient(run);
  shift(run, to, hole.step);
  run.motion().go(hole.axis, hole.level, true);
  shift(run, to, -hole.step);
  run.motion().turn_spindle(turning == SpindleMode::ccw ? turning : SpindleMode::cw);
  run.motion().go(hole.axis, hole.depth, false);
  orient(run);
  dwell(run, hole.dwell_s);
  shift(run, to, hole.step);
  run.motion().go(hole.axis, hole.initial, true);
  shift(run, to, -hole.step);
  if (turning != SpindleMode::stop) run.motion().turn_spindle(turning);
}

void tap(Execution& run, const Hole& hole) {
  const int deep = static_cast<int>(setting(run, "ZSFI1"));
  Tapping thread;
  thread.name = hole.name;
  thread.axis = hole.axis;
  thread.approach = hole.level;
  thread.depth = hole.depth;
  thread.lead = tapping_lead(run, hole);
  thread.in = hole.g == 84 ? SpindleMode::cw : SpindleMode::ccw;
  thread.dwell_s = thread.dwell_out_s = hole.dwell_s;
  thread.back_share = setting(run, "ZSFI2") / 100.0;
  if (deep >= 2 && hole.step > 0.0) {
    thread.step = hole.step;
    thread.back = breaking(run);
    thread.leaves = deep == 3;
  }
  tap_hole(run, thread);
}

}  // namespace

void milled_hole(Execution& run, const Hole& hole) {
  if (hole.g == 74 || hole.g == 84) return tap(run, hole);
  if (run.state().motion.feed <= 0.0) fail(Fault::feed_missing, hole.column);
  if (hole.g == 76) return fine_boring(run, hole);
  if (hole.g == 87) return back_boring(run, hole);
  Boring work;
  work.name = hole.name;
  work.axis = hole.axis;
  work.approach = work.retreat = hole.level;
  work.depth = hole.depth;
  work.stops = hole.g == 86;
  if (hole.g == 82 || hole.g == 89) work.dwell_bottom_s = hole.dwell_s;
  if (hole.g == 85 || hole.g == 89) work.back_feed = run.state().motion.feed;
  if (hole.g == 73 && hole.step > 0.0) work.chips = {.on = true, .pass = hole.step, .back = breaking(run)};
  if (hole.g == 83 && hole.step > 0.0) {
    work.first = work.next = hole.step;
    work.reentry = reentry(run, hole.depth - hole.level);
  }
  bore(run, work);
}

}  // namespace servogate::program::sinumerik::iso
