// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"
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

namespace {

void windows(Execution& run, const Word& word, const char* name, bool coarse) {
  if (word.column == 0) fail(Fault::power_on_for_block, 0, {name});
  InPosition wanted;
  for (int axis = 0; axis < run.machine().real_axes(); ++axis) {
    wanted.axes |= 1u << axis;
    if (coarse)
      wanted.window[static_cast<std::size_t>(axis)] =
          run.machine().axes[static_cast<std::size_t>(axis)].window_coarse;
  }
  run.emit(wanted);
}

}  // namespace

void fine_stop(Execution& run, BlockWords&, const Word& word) { windows(run, word, "G601", false); }
void coarse_stop(Execution& run, BlockWords&, const Word& word) { windows(run, word, "G602", true); }

void feed_of_contour(Execution& run, const Word&) { run.state().motion.arc_feed = ArcFeed::contour; }
void feed_of_centre(Execution& run, const Word&) { run.state().motion.arc_feed = ArcFeed::tool_centre; }
void feed_of_inside(Execution& run, const Word&) { run.state().motion.arc_feed = ArcFeed::inside; }

void to_iso(Execution& run, const BlockWords& words) {
  for (std::size_t i = 0; i < run.block().count; ++i)
    if (&run.block().words[i] != words.instead_word)
      fail(iso::Wrong::switch_alone, run.block().words[i].column, {"G291"});
  run.motion().end_profile();
  run.speak(iso::dialect(run.machine()));
}

}  // namespace servogate::program::sinumerik
