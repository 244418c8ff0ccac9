// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/sinumerik/iso/faults.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

/// The programmable frame: a shift, and a rotation in the plane about the shifted zero. TRANS and ROT begin
/// anew, ATRANS and AROT add to what is in force, along the axes as they are turned then.
namespace servogate::program::sinumerik {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

void clear(Execution& run) {
  Frame& frame = run.state().frames.frame;
  for (int a = 0; a < run.machine().axis_count(); ++a) frame.set_offset(a, 0.0);
  frame.set_rotation(0.0);
}

/// The words of a shift; along a diameter axis they count as radii.
Position shift(const Execution& run, const BlockWords& words) {
  Position by{};
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (const Word* word = words.axis[at(a)]; word != nullptr)
      by[at(a)] = run.numbers().length(a, word->value, false);
  return by;
}

void add_shift(Execution& run, const BlockWords& words) {
  BlockWords others = words;
  others.axis = {};
  run.refuse_all_but(others, {});
  Frame& frame = run.state().frames.frame;
  Position by = shift(run, words);
  const FramesState& frames = run.state().frames;
  if (frame.rotation() != 0.0 && frames.axis1 >= 0 && frames.axis2 >= 0) {
    const double x = by[at(frames.axis1)], y = by[at(frames.axis2)];
    const double c = cos_deg(frame.rotation()), s = sin_deg(frame.rotation());
    by[at(frames.axis1)] = x * c - y * s;
    by[at(frames.axis2)] = x * s + y * c;
  }
  for (int a = 0; a < run.machine().axis_count(); ++a) frame.set_offset(a, frame.offset(a) + by[at(a)]);
  run.frames().changed();
}

void add_rotation(Execution& run, const BlockWords& words) {
  for (const Word* word : words.axis)
    if (word != nullptr)
      fail(iso::Wrong::rotation_axis, word->column, {word_text(run.dialect(), run.block(), *word)});
  run.refuse_all_but(words, {words.angle});
  Frame& frame = run.state().frames.frame;
  const double angle = words.angle == nullptr ? 0.0 : run.numbers().resolve(words.angle->value);
  if (angle != 0.0) run.frames().need_plane(words.angle->column);
  frame.set_rotation(std::fmod(frame.rotation() + angle, 360.0));
  run.frames().changed();
}

}  // namespace

void trans(Execution& run, const BlockWords& words) {
  clear(run);
  add_shift(run, words);
}

void atrans(Execution& run, const BlockWords& words) { add_shift(run, words); }

void rot(Execution& run, const BlockWords& words) {
  clear(run);
  add_rotation(run, words);
}

void arot(Execution& run, const BlockWords& words) { add_rotation(run, words); }

}  // namespace servogate::program::sinumerik
