// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/tapping.hpp"

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

constexpr int kMostPasses = 10'000;

void dwell(Execution& run, double seconds) {
  if (seconds > 0.0) run.motion().dwell(seconds);
}

void turn(Execution& run, SpindleMode mode, double share = 1.0) { run.motion().turn_spindle(mode, share); }

}  // namespace

void tap_hole(Execution& run, const Tapping& thread) {
  const SpindleMode out = thread.in == SpindleMode::cw ? SpindleMode::ccw : SpindleMode::cw;
  const double down = thread.depth < thread.approach ? -1.0 : 1.0;
  run.motion().go(thread.axis, thread.approach, true);
  if (run.state().motion.spindle != thread.in) turn(run, thread.in);
  double bottom = thread.approach;
  for (int pass = 0; thread.step > 0.0; ++pass) {
    if (pass == kMostPasses) fail(Fault::cycle_pecks, 0, {thread.name, std::to_string(kMostPasses)});
    bottom += down * thread.step;
    if ((thread.depth - bottom) * down < 1e-9) break;
    run.motion().tap(thread.axis, bottom, thread.lead);
    turn(run, out);
    run.motion().tap(thread.axis, thread.leaves ? thread.approach : bottom - down * thread.back, thread.lead);
    turn(run, thread.in);
  }
  run.motion().tap(thread.axis, thread.depth, thread.lead);
  dwell(run, thread.dwell_s);
  turn(run, out, thread.back_share);
  run.motion().tap(thread.axis, thread.approach, thread.lead);
  dwell(run, thread.dwell_out_s);
  turn(run, thread.in);
}

}  // namespace servogate::program
