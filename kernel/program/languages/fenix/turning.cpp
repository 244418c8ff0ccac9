// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/turning.hpp"

#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/arguments.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

/// G70 to G78 (specification 18).
namespace servogate::program::fenix {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

enum class Kind { once, rough, pecks, grooves };

/// How a G word maps onto a turning cycle.
struct Row {
  int number;
  Kind kind;
  bool along_z;  ///< cuts along Z, otherwise along X
};
constexpr Row kRows[] = {
    {70, Kind::once, true},    {71, Kind::once, false},    {72, Kind::pecks, false}, {73, Kind::pecks, true},
    {74, Kind::grooves, true}, {75, Kind::grooves, false}, {77, Kind::rough, true},  {78, Kind::rough, false},
};

const Row& row_of(int number) {
  for (const Row& row : kRows)
    if (row.number == number) return row;
  return kRows[0];
}

/// A length that an argument gives along an axis; of a diameter axis a diameter, whatever mode is in force.
double length_along(const Execution& run, int axis, double value) {
  return run.machine().axes[at(axis)].diameter ? std::abs(value) / 2.0 : std::abs(value);
}

double end_of(const Execution& run, const BlockWords& words, int axis) {
  const Word* word = words.axis[at(axis)];
  const double from = run.state().frames.programmed[at(axis)];
  if (word == nullptr) return from;
  const double value = run.numbers().length(axis, word->value);
  return run.state().modes.dimension == Function::incremental ? from + value : value;
}

}  // namespace

void turning(Execution& run, const BlockWords& words) {
  const Arguments arguments(run, words);
  const Row& row = row_of(static_cast<int>(words.instead_word->value.number));
  run.frames().need_plane(arguments.column());
  run.refuse_words_but_axes(words);
  run.motion().store_feed(words);
  run.motion().end_profile();
  forget_profile(run.state());
  arguments.at_most(row.kind == Kind::once || row.kind == Kind::rough ? 2 : 1);
  const FramesState& frames = run.state().frames;
  Turning cycle;
  cycle.name = arguments.name();
  cycle.along = row.along_z ? frames.axis1 : frames.axis2;
  cycle.across = row.along_z ? frames.axis2 : frames.axis1;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axis[at(a)] != nullptr && a != cycle.along && a != cycle.across)
      fail(Fault::word_without_function, words.axis[at(a)]->column,
           {word_text(run.dialect(), run.block(), *words.axis[at(a)])});
  const auto need = [&](int axis) {
    if (words.axis[at(axis)] == nullptr)
      fail(Wrong::cycle_axis, arguments.column(), {cycle.name, run.machine().axes[at(axis)].letter});
  };
  need(cycle.along);
  if (row.kind != Kind::pecks) need(cycle.across);
  cycle.along_end = end_of(run, words, cycle.along);
  cycle.across_end = end_of(run, words, cycle.across);
  cycle.sets_at_rapid = run.state().modes.motion == Function::rapid;
  cycle.clearance = std::abs(run.machine().variable("P404", 1.0));
  if (row.kind == Kind::once) {
    cycle.bevel_along = length_along(run, cycle.along, arguments.number(0));
    cycle.bevel_across = length_along(run, cycle.across, arguments.number(1));
    return turn_once(run, cycle);
  }
  const int stepped = row.kind == Kind::pecks ? cycle.along : cycle.across;
  cycle.step = length_along(run, stepped, arguments.required(0));
  if (!(cycle.step > 0.0))
    fail(Wrong::step, arguments.column(), {cycle.name, text::number(arguments.number(0))});
  if (row.kind == Kind::grooves) return turn_grooves(run, cycle);
  if (row.kind == Kind::rough) {
    cycle.bevel_along = length_along(run, cycle.along, arguments.number(1));
    return turn_rough(run, cycle);
  }
  turn_pecks(run, cycle);
  run.motion().go(cycle.across, cycle.across_end, true);
}

}  // namespace servogate::program::fenix
