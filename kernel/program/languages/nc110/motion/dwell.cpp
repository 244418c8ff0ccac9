// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"

namespace servogate::program::nc110 {

double dwell_seconds(const Execution& run) {
  const State& state = run.state();
  if (state.modes.feed != Function::feed_revolution || state.motion.dwell <= 0.0) return state.motion.dwell;
  const int column = static_cast<int>(run.block().body) + 1;
  if (state.modes.spindle == Function::surface_speed) fail(Wrong::dwell_surface_speed, column);
  if (state.modes.speed <= 0.0) fail(Wrong::dwell_no_speed, column);
  return state.motion.dwell * 60.0 / state.modes.speed;
}

void check_dwell(Execution& run, const Word& word) {
  if (run.state().motion.dwell > 0.0) return;
  Written place = run.capability().written(word.column);
  run.capability().warn(place, entry(Wrong::dwell_zero), {word_text(run.dialect(), run.block(), word)});
}

void dwell(Execution& run, const Word& word) {
  check_dwell(run, word);
  run.motion().dwell(dwell_seconds(run));
}

}  // namespace servogate::program::nc110
