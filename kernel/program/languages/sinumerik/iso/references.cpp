// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// G27, G28, G30 and G53 (specification 6, 8.1).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr double kInPosition = 0.01;  ///< mm or degrees

void begin(Execution& run, const BlockWords& words, std::string_view letters) {
  only(run, letters);
  refuse_scaled(run, words);
  const int place = column(words);
  if (run.contour().engaged()) fail(Wrong::compensated, place, {g_word(run, words), "G41/G42"});
  if (words.axes == 0) fail(Wrong::axis_alone, place, {g_word(run, words)});
  run.motion().end_profile();
}

void to_point(Execution& run, const BlockWords& words) {
  const Position to = run.motion().target_of(words);
  if (to != run.state().frames.machine) run.motion().rapid_to(to);
}

/// By the intermediate point; on a milling machine the length of the tool ends there.
template <typename Reference>
void go(Execution& run, const BlockWords& words, Reference&& reference) {
  to_point(run, words);
  Position to = run.state().frames.machine;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axis[at(a)] != nullptr) to[at(a)] = reference(a);
  if (to != run.state().frames.machine) run.motion().rapid_to(to);
  State& state = run.state();
  const int axis = state.frames.normal;
  if (run.machine().turns() || axis < 0 || words.axis[at(axis)] == nullptr ||
      value(state, own::length_sign) == 0.0)
    return;
  value(state, own::length_sign) = 0.0;
  state.frames.frame.set_length(axis, 0.0);
  run.frames().changed();
}

constexpr std::string_view kAxes = "XYZABCUVWH";

}  // namespace

void reference_return(Execution& run, const BlockWords& words) {
  begin(run, words, kAxes);
  go(run, words, [&run](int axis) { return reference_position(run, axis, 1); });
}

void reference_other(Execution& run, const BlockWords& words) {
  begin(run, words, "XYZABCUVWHP");
  const int n = whole(run, 'P', 2);
  if (n < 2 || n > 4)
    fail(Wrong::reference_number, find(run.block(), 'P')->column, {g_word(run, words), std::to_string(n)});
  go(run, words, [&run, n](int axis) { return reference_position(run, axis, n); });
}

/// G30.1: a point of each axis that the machine file has.
void reference_floating(Execution& run, const BlockWords& words) {
  begin(run, words, kAxes);
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (const Word* word = words.axis[at(a)]; word != nullptr && !axis_setting(run, "FLOATING_", a))
      fail(Wrong::floating_missing, word->column, {g_word(run, words), run.machine().axes[at(a)].letter});
  go(run, words, [&run](int axis) { return axis_setting(run, "FLOATING_", axis).value_or(0.0); });
}

/// G60: each axis comes to its end from the side of its overrun, at rapid.
void one_sided(Execution& run, const BlockWords& words) {
  begin(run, words, kAxes);
  const Position to = run.motion().target_of(words);
  Position beyond = to;
  bool any = false;
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    if (words.axis[at(a)] == nullptr) continue;
    const auto overrun = axis_setting(run, "OVERRUN_", a);
    any = any || overrun;
    beyond[at(a)] += overrun.value_or(0.0);
  }
  if (!any) fail(Wrong::overrun_missing, column(words), {g_word(run, words)});
  if (beyond != run.state().frames.machine) run.motion().rapid_to(beyond);
  if (to != beyond) run.motion().rapid_to(to);
}

void reference_check(Execution& run, const BlockWords& words) {
  begin(run, words, kAxes);
  to_point(run, words);
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    const Word* word = words.axis[at(a)];
    const double stands = run.state().frames.machine[at(a)], wanted = reference_position(run, a, 1);
    if (word == nullptr || std::abs(stands - wanted) <= kInPosition) continue;
    const MachineModel::Axis& axis = run.machine().axes[at(a)];
    const double shown = axis.diameter ? 2.0 : 1.0;
    fail(Wrong::reference_position, word->column,
         {axis.letter, text::number(shown * stands, 4), text::number(shown * wanted, 4)});
  }
}

/// With MD10760 = 1 the tool's own lengths do not count in the block.
void machine_coordinates(Execution& run, const BlockWords& words) {
  only(run, "XYZABCUVWHFSTM");
  run.motion().store_feed(words);
  if (words.axes == 0) fail(Wrong::axis_alone, column(words), {"G53"});
  if (run.contour().engaged()) fail(Wrong::compensated, column(words), {"G53", "G41/G42"});
  refuse_scaled(run, words);
  const FramesState& frames = run.state().frames;
  Position to = frames.machine;
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    const Word* word = words.axis[at(a)];
    if (word == nullptr) continue;
    if (word->value.dimension == Dimension::incremental)
      fail(Fault::word_without_function, word->column, {word_text(run.dialect(), run.block(), *word)});
    to[at(a)] = run.numbers().length(a, word->value) +
                (setting(run, "MD10760") == 1.0 ? 0.0 : frames.frame.length(a));
  }
  if (run.state().modes.motion == Function::rapid) return run.motion().rapid_to(to);
  Position programmed = frames.programmed;
  for (int a = 0; a < run.machine().axis_count(); ++a) programmed[at(a)] = frames.frame.to_programmed(to, a);
  run.motion().go(programmed, false);
}

}  // namespace servogate::program::sinumerik::iso
