// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/fenix/arguments.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

/// Lines and arcs whose end is given by an angle (specification 7). The view has Z to the right and X
/// downwards, angles count counter-clockwise in it.
namespace servogate::program::fenix {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

/// A word that stands for what the block leaves to the control; of a diameter axis as its words count.
Word made_up(const Execution& run, const Word& place, int axis, double way) {
  Word word = place;
  const bool diameter =
      run.machine().axes[at(axis)].diameter && run.state().modes.across == Function::diameter;
  word.value = Value{};
  word.value.number = diameter ? 2.0 * way : way;
  word.value.column = place.column;
  word.value.dimension = Dimension::incremental;
  return word;
}

/// How far the block leads an axis that it names.
double way_of(const Execution& run, const BlockWords& words, int axis) {
  const Word* word = words.axis[at(axis)];
  if (word == nullptr) return 0.0;
  const double value = run.numbers().length(axis, word->value);
  return run.state().modes.dimension == Function::incremental
             ? value
             : value - run.state().frames.programmed[at(axis)];
}

void line_by_angle(Execution& run, const BlockWords& words) {
  const Arguments arguments(run, words);
  const int column = words.instead_word->column;
  run.frames().need_plane(column);
  run.refuse_words_but_axes(words);
  run.motion().store_feed(words);
  const int z = run.state().frames.axis1, x = run.state().frames.axis2;
  const bool along_z = words.axis[at(z)] != nullptr, along_x = words.axis[at(x)] != nullptr;
  if (along_z && along_x) fail(Wrong::over_defined, column, {arguments.name()});
  if (!along_z && !along_x) fail(Wrong::line_axis, column, {arguments.name()});
  const double angle = arguments.number(0);
  if (std::abs(cos_deg(angle)) < 1e-9)
    fail(Wrong::line_angle, column, {arguments.name(), run.machine().axes[at(along_z ? z : x)].letter});
  const int other = along_z ? x : z;
  const double way = way_of(run, words, along_z ? z : x) * tan_deg(angle);
  const Word word = made_up(run, *words.instead_word, other, -way);
  BlockWords all = words;
  all.axis[at(other)] = &word;
  ++all.axes;
  run.motion().move(all);
}

void arc_by_angle(Execution& run, const BlockWords& words) {
  const Arguments arguments(run, words);
  const int column = words.instead_word->column;
  run.frames().need_plane(column);
  run.motion().store_feed(words);
  const int a1 = run.state().frames.axis1, a2 = run.state().frames.axis2;
  const auto diameter = [](const MachineModel::Axis& axis) { return axis.diameter; };
  const double most = std::ranges::any_of(run.machine().axes, diameter) ? 180.0 : 360.0;
  const double angle = std::abs(arguments.number(0));
  const double d1 = way_of(run, words, a1), d2 = way_of(run, words, a2), chord = std::hypot(d1, d2);
  const double half = sin_deg(angle / 2.0);
  if (!(angle > 0.0 && angle <= most) || half < 1e-9)
    fail(Wrong::arc_angle, column, {text::number(angle), text::number(most)});
  if (chord < 1e-9) fail(Fault::arc_zero, column);
  const double side = run.state().modes.motion == Function::arc_ccw ? 1.0 : -1.0;
  const double away =
      side * chord / (2.0 * half) * cos_deg(angle / 2.0) / chord;  // of the centre from the chord
  const Word first = made_up(run, *words.instead_word, a1, d1 / 2.0 - away * d2);
  const Word second = made_up(run, *words.instead_word, a2, d2 / 2.0 + away * d1);
  BlockWords all = words;
  all.centre1 = &first;
  all.centre2 = &second;
  run.motion().move(all);
}

void take(BlockWords& words, const Word& word, void (*motion)(Execution&, const BlockWords&)) {
  if (word.argument_count == 0) return;
  words.instead = motion;
  words.instead_word = &word;
}

}  // namespace

void take_line(Execution&, BlockWords& words, const Word& word) { take(words, word, line_by_angle); }
void take_arc(Execution&, BlockWords& words, const Word& word) { take(words, word, arc_by_angle); }

}  // namespace servogate::program::fenix
