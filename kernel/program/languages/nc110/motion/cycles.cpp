// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"

namespace servogate::program::nc110 {
namespace {

constexpr double kClearance = 1.0;  ///< mm by which G83 re-enters above the last bottom (R1 := R1 + I - 1)
constexpr int kMaxPecks = 10'000;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

[[noreturn]] void stray(const Execution& run, const Word& word) {
  fail(Fault::word_without_function, word.column, {word_text(run.dialect(), run.block(), word)});
}

/// A level of the cycle's axis; with G91 from where the axis stands at this block (specification A 24,
/// decision 32).
double level(const Execution& run, int axis, const Word& word) {
  const double value = run.length(axis, word.value);
  const bool incremental = run.state().modes.dimension == Function::incremental;
  return incremental ? run.state().programmed[at(axis)] + value : value;
}

int cycle_axis(const Execution& run, const BlockWords& words) {
  const Modes& modes = run.state().modes;
  int found = -1;
  for (int a = 0; a < run.axis_count(); ++a) {
    const Word* word = words.axis[at(a)];
    if (word == nullptr) continue;
    if (words.axes > 1 && (a == modes.axis1 || a == modes.axis2))
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
    cycle.levels_at = run.written(word->column);
}

/// Levels between which nothing is worked, or otherwise than people mean them; `from`: where the axis stands.
void check_levels(Execution& run, Cycle& cycle, double from) {
  const std::string number = std::to_string(cycle.number), depth = text::number(cycle.depth, 4),
                    approach = text::number(cycle.approach, 4);
  const double down = cycle.depth - cycle.approach;
  if (down == 0.0)
    run.warn(cycle.levels_at, entry(Wrong::cycle_no_depth), {number, depth, approach});
  else if ((cycle.depth - from) * (cycle.approach - cycle.depth) > 0.0)
    run.warn(cycle.levels_at, entry(Wrong::cycle_passes_depth), {number, depth, approach});
  else if ((cycle.retreat - cycle.approach) * down > 0.0)
    run.warn(cycle.levels_at, entry(Wrong::cycle_return_below),
             {number, depth, text::number(cycle.retreat, 4), approach});
}

void take_pecks(const Execution& run, const BlockWords& words, Cycle& cycle) {
  if (cycle.number != 83) {
    if (cycle.number == 84 && words.pitch != nullptr)
      fail(Fault::not_executed, words.pitch->column,
           {"G84 with " + word_text(run.dialect(), run.block(), *words.pitch)});
    for (const Word* word : {words.centre1, words.centre2, words.pitch})
      if (word != nullptr) stray(run, *word);
    return;
  }
  if (words.centre1 == nullptr) fail(Wrong::cycle_step_missing, words.cycle_word->column);
  cycle.step = std::abs(run.length(cycle.axis, words.centre1->value, false));
  cycle.factor = words.pitch != nullptr     ? run.resolve(words.pitch->value)
                 : words.centre2 != nullptr ? 1.0
                                            : 0.0;
  if (words.centre2 != nullptr && words.pitch != nullptr)
    cycle.min_step = std::abs(run.length(cycle.axis, words.centre2->value, false));
  const bool removes = cycle.factor != 0.0;
  const double least = removes ? kClearance : 0.0;
  if (!(cycle.step > least))
    fail(Wrong::cycle_step, words.centre1->value.column, {text::number(cycle.step, 4), text::number(least)});
  if (removes && !(cycle.factor > 0.0)) run.refuse_range("K", words.pitch->value, cycle.factor, "0.001", "1");
}

/// The block of the G word only stores the cycle.
void define(Execution& run, const BlockWords& words) {
  State& state = run.state();
  if (state.cycle.number != 0)
    fail(Wrong::cycle_active, words.cycle_word->column,
         {std::to_string(words.cycle), std::to_string(state.cycle.number)});
  run.need_plane(words.cycle_word->column);
  Cycle cycle;
  cycle.number = words.cycle;
  cycle.axis = cycle_axis(run, words);
  cycle.approach = cycle.retreat = state.programmed[at(cycle.axis)];
  take_levels(run, words, cycle);
  take_pecks(run, words, cycle);
  if (cycle.number == 82 || cycle.number == 89) check_dwell(run, *words.cycle_word);
  state.cycle = cycle;
}

void dwell_at_bottom(Execution& run) {
  const double seconds = dwell_seconds(run);
  if (seconds > 0.0) run.dwell(seconds);
}

/// G83 without K and J: the chip is broken, the tool stays in the hole.
void break_chips(Execution& run, const Cycle& cycle, double sign) {
  double bottom = cycle.approach;
  for (int pecks = 0; bottom != cycle.depth; ++pecks) {
    if (pecks == kMaxPecks) fail(Wrong::cycle_pecks, 0, {std::to_string(kMaxPecks)});
    bottom += sign * cycle.step;
    if ((bottom - cycle.depth) * sign > -1e-9) bottom = cycle.depth;
    run.go(cycle.axis, bottom, false);
    dwell_at_bottom(run);
  }
}

/// G83 with K: out to the first level after each step; it re-enters a clearance above the last bottom, and
/// the next step is counted from there, as printed in the manual.
void remove_chips(Execution& run, const Cycle& cycle, double sign) {
  double from = cycle.approach, step = cycle.step;
  for (int pecks = 0;; ++pecks) {
    if (pecks == kMaxPecks) fail(Wrong::cycle_pecks, 0, {std::to_string(kMaxPecks)});
    if (step <= kClearance) fail(Wrong::cycle_step, 0, {text::number(step, 4), text::number(kClearance)});
    double bottom = from + sign * step;
    const bool last = (bottom - cycle.depth) * sign > -1e-9;
    if (last) bottom = cycle.depth;
    run.go(cycle.axis, bottom, false);
    if (last) return;
    run.go(cycle.axis, cycle.approach, true);
    from += sign * (step - kClearance);
    run.go(cycle.axis, from, true);
    step = step * cycle.factor >= cycle.min_step ? step * cycle.factor : cycle.min_step;
  }
}

SpindleMode reversed(SpindleMode mode) {
  return mode == SpindleMode::cw ? SpindleMode::ccw : mode == SpindleMode::ccw ? SpindleMode::cw : mode;
}

/// Down from the approach level, what happens at the bottom, and back up.
void work(Execution& run) {
  Cycle& cycle = run.state().cycle;
  const double sign = cycle.depth < cycle.approach ? -1.0 : 1.0;
  const bool back_at_feed = cycle.number == 84 || cycle.number == 85 || cycle.number == 89;
  if (cycle.number == 83) {
    cycle.factor != 0.0 ? remove_chips(run, cycle, sign) : break_chips(run, cycle, sign);
  } else {
    run.go(cycle.axis, cycle.depth, false);
  }
  if (cycle.number == 82 || cycle.number == 89) dwell_at_bottom(run);
  const SpindleMode mode = run.state().spindle;
  if (cycle.number == 84) run.emit_spindle(reversed(mode));
  if (cycle.number == 86 && mode != SpindleMode::stop) {
    run.emit_spindle(SpindleMode::stop);
    run.state().spindle = mode;
    cycle.spindle_rests = true;
  }
  if (back_at_feed) run.go(cycle.axis, cycle.approach, false);
  if (cycle.number == 84) run.emit_spindle(mode);
  run.go(cycle.axis, cycle.retreat, true);
}

}  // namespace

void cycle(Execution& run, const BlockWords& words) {
  if (words.cycle != 0) return define(run, words);
  for (const Word* word : {words.centre1, words.centre2, words.pitch})
    if (word != nullptr) stray(run, *word);
  Cycle& active = run.state().cycle;
  const bool depth = words.axis[at(active.axis)] != nullptr;
  const int places = words.axes - (depth ? 1 : 0);
  const Word* level_word = words.radius != nullptr ? words.radius : words.axis[at(active.axis)];
  if (places == 0) {
    if (level_word != nullptr)
      fail(Wrong::cycle_hole, level_word->column, {word_text(run.dialect(), run.block(), *level_word)});
    return;
  }
  run.position(words, active.axis);
  take_levels(run, words, active);
  check_levels(run, active, run.state().programmed[at(active.axis)]);
  run.go(active.axis, active.approach, true);
  if (active.spindle_rests) run.emit_spindle(run.state().spindle);
  active.spindle_rests = false;
  work(run);
}

}  // namespace servogate::program::nc110
