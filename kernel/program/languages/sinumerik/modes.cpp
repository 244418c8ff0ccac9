// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

namespace servogate::program::sinumerik {

void lengths_only(Execution& run, BlockWords&, const Word&) { run.state().motion.feed_metric = true; }
void with_feeds(Execution& run, BlockWords&, const Word&) { run.state().motion.feed_metric = false; }

void new_feed(Execution& run, BlockWords&, const Word&) {
  State& state = run.state();
  double& before = state.own[0];  // 0: as at power-on, a feed per minute
  const double now = state.modes.feed == Function::feed_revolution ? 1.0 : 0.0;
  if (before != now) state.motion.feed = 0.0;
  before = now;
}

}  // namespace servogate::program::sinumerik
