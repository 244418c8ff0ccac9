// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/cycles/canned.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"

namespace servogate::program::nc110 {
namespace {

constexpr double kClearance = 1.0;  ///< mm by which G83 re-enters above the last bottom (R1 := R1 + I - 1)

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

[[noreturn]] void stray(const Execution& run, const Word& word) {
  fail(Fault::word_without_function, word.column, {word_text(run.dialect(), run.block(), word)});
}

/// A level of the cycle's axis; with G91 from where the axis stands at this block (specification A 24,
/// decision 32).
double level(const Execution& run, int axis, const Word& word) {
  const double value = run.numbers().length(axis, word.value);
  const bool incremental = run.state().modes.dimension == Function::incremental;
  return incremental ? run.state().frames.programmed[at(axis)] + value : value;
}

int cycle_axis(const Execution& run, const BlockWords& words) {
  const FramesState& frames = run.state().frames;
  int found = -1;
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    const Word* word = words.axis[at(a)];
    if (word == nullptr) continue;
    if (words.axes > 1 && (a == frames.axis1 || a == frames.axis2))
      fail(Wrong::cycle_motion, word->column, {word_text(run.dialect(), run.block(), *word)});
    if (found >= 0) fail(Wrong::cycle_motion, word->column, {word_text(run.dialect(), run.block(), *word)});
    found = a;
  }
  if (found < 0) fail(Wrong::cycle_depth, words.cycle_word->column, {std::to_string(words.cycle)});
  return found;
}

void take_levels(const Execution& run, const BlockWords& words, Cycle& cycle) {
  if (words.radius != nullptr) cycle.approach = cycle.retreat = level(run, cycle.axis, *words.radius);
  if (words.radius2 != nullptr) cycle.retreat = level(run, cycle.axis, *words.radius2);
  const Word* depth = words.axis[at(cycle.axis)];
  if (depth != nullptr) cycle.depth = level(run, cycle.axis, *depth);
  if (const Word* word = depth != nullptr ? depth : words.radius; word != nullptr)
    cycle.levels_at = run.capability().written(word->column);
}

/// K is the pitch of a tap that follows the turns of the spindle; RMS is its way back in per cent.
void take_lead(const Execution& run, const BlockWords& words, Cycle& cycle) {
  const double percent = run.state().own[at(Own::rms)];
  cycle.back_share = percent > 0.0 ? percent / 100.0 : 1.0;
  if (words.pitch == nullptr) return;
  cycle.lead = run.numbers().length(cycle.axis, words.pitch->value, false);
  if (!(cycle.lead > 0.0)) fail(Wrong::thread_lead, words.pitch->column);
  if (run.machine().spindles == 0) fail(Fault::no_spindle, words.pitch->column, {"G84 K"});
  if (run.state().modes.cutting || run.state().modes.speed <= 0.0)
    fail(Wrong::tap_no_speed, words.pitch->column);
}

void take_pecks(const Execution& run, const BlockWords& words, Cycle& cycle) {
  if (words.cycle != 83) {
    const bool taps = words.cycle == 84;
    for (const Word* word : {words.centre1, words.centre2, taps ? nullptr : words.pitch})
      if (word != nullptr) stray(run, *word);
    if (taps) take_lead(run, words, cycle);
    return;
  }
  if (words.centre1 == nullptr) fail(Wrong::cycle_step_missing, words.cycle_word->column);
  cycle.step = std::abs(run.numbers().length(cycle.axis, words.centre1->value, false));
  cycle.factor = words.pitch != nullptr     ? run.numbers().resolve(words.pitch->value)
                 : words.centre2 != nullptr ? 1.0
                                            : 0.0;
  if (words.centre2 != nullptr && words.pitch != nullptr)
    cycle.min_step = std::abs(run.numbers().length(cycle.axis, words.centre2->value, false));
  const bool removes = cycle.factor != 0.0;
  cycle.clearance = removes ? kClearance : 0.0;
  if (!(cycle.step > cycle.clearance))
    fail(Fault::cycle_step, words.centre1->value.column,
         {cycle.name, text::number(cycle.step, 4), text::number(cycle.clearance)});
  if (removes && !(cycle.factor > 0.0))
    run.numbers().refuse_range("K", words.pitch->value, cycle.factor, "0.001", "1");
}

/// The block of the G word only stores the cycle.
void define(Execution& run, const BlockWords& words) {
  State& state = run.state();
  if (!state.motion.cycle.name.empty())
    fail(Wrong::cycle_active, words.cycle_word->column,
         {std::to_string(words.cycle), state.motion.cycle.name});
  run.frames().need_plane(words.cycle_word->column);
  Cycle cycle;
  cycle.name = "G" + std::to_string(words.cycle);
  cycle.axis = cycle_axis(run, words);
  cycle.approach = cycle.retreat = state.frames.programmed[at(cycle.axis)];
  take_levels(run, words, cycle);
  take_pecks(run, words, cycle);
  cycle.dwells = words.cycle == 82 || words.cycle == 89;
  if (cycle.dwells) check_dwell(run, *words.cycle_word);
  if (words.cycle == 83) cycle.dwells = cycle.factor == 0.0;
  cycle.back_at_feed = words.cycle == 84 || words.cycle == 85 || words.cycle == 89;
  if (words.cycle == 84) cycle.at_bottom = Cycle::Spindle::reverses;
  if (words.cycle == 86) cycle.at_bottom = Cycle::Spindle::stops;
  state.motion.cycle = cycle;
}

/// A tap has to reach its feed and to stop within its stroke (specification A 10.4).
void check_stroke(const Execution& run, const Cycle& cycle, int column) {
  if (cycle.name != "G84" || cycle.lead > 0.0) return;
  const MachineModel::Axis& axis = run.machine().axes[at(cycle.axis)];
  const State& state = run.state();
  if (axis.acceleration <= 0.0 || axis.jerk <= 0.0 || state.modes.feed == Function::feed_inverse) return;
  const double turns = state.modes.feed == Function::feed_revolution ? state.modes.speed : 1.0;
  const double v = state.motion.feed * (state.motion.feed_inch ? 25.4 : 1.0) * turns / 60.0;
  const double reached = axis.acceleration * axis.acceleration / axis.jerk;
  const double time =
      v >= reached ? v / axis.acceleration + axis.acceleration / axis.jerk : 2.0 * std::sqrt(v / axis.jerk);
  const double stroke = std::abs(cycle.approach - cycle.depth), needed = v * time;
  if (stroke > 0.0 && stroke < needed)
    fail(Wrong::tap_short, column,
         {text::number(stroke, 4), text::number(v * 60.0, 2), text::number(needed, 2)});
}

}  // namespace

void cycle(Execution& run, const BlockWords& words) {
  if (words.cycle != 0) return define(run, words);
  for (const Word* word : {words.centre1, words.centre2, words.pitch})
    if (word != nullptr) stray(run, *word);
  Cycle& active = run.state().motion.cycle;
  const bool depth = words.axis[at(active.axis)] != nullptr;
  const int places = words.axes - (depth ? 1 : 0);
  const Word* level_word = words.radius != nullptr ? words.radius : words.axis[at(active.axis)];
  if (places == 0) {
    if (level_word != nullptr)
      fail(Wrong::cycle_hole, level_word->column, {word_text(run.dialect(), run.block(), *level_word)});
    return;
  }
  run.motion().position(words, active.axis);
  take_levels(run, words, active);
  if (active.dwells) active.dwell_s = dwell_seconds(run);
  check_stroke(run, active, column_of(run.block(), -1));
  work_hole(run, active);
}

}  // namespace servogate::program::nc110
