// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/execution/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace servogate::program {
namespace {

constexpr double kMaxTurns = 1000.0;
constexpr double kDegree = std::numbers::pi / 180.0;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

}  // namespace

/// Centre of the arc a block asks for, by its radius or by the words of a centre.
Point Motion::find_centre(const BlockWords& words, Point start, Point end, bool counter_clockwise) const {
  const bool one = words.centre1 != nullptr || words.centre2 != nullptr;
  const bool both = words.centre1 != nullptr && words.centre2 != nullptr;
  const auto letters = [this](std::string last) {
    const bool named = dialect_.letter_of(Meaning::centre_1) != 0;
    return std::vector<std::string>{named ? letter(Meaning::centre_1) : "I",
                                    named ? letter(Meaning::centre_2) : "J, K", std::move(last)};
  };
  const auto r_word = [this] {
    const WordRule* named = dialect_.word_of(Meaning::radius);
    return named != nullptr ? std::string(named->name) + "=" : letter(Meaning::radius);
  };
  if (words.radius == nullptr) {
    if (!one) fail(Fault::arc_words, here(), letters(r_word()));
    if (!both && dialect_.arc_centre != ArcCentre::from_start_any)
      fail(Fault::arc_centre_pair, here(),
           letters(letter(words.centre1 == nullptr ? Meaning::centre_1 : Meaning::centre_2)));
    return arc_centre(words);
  }
  const int column = words.radius->column;
  if (one) fail(Fault::arc_both, column, letters(r_word()));
  const int a1 = at_.axis1;
  const double r = numbers_.length(a1, words.radius->value, false) * std::abs(at_.frame.scale(a1));
  if (r == 0.0) fail(Fault::arc_zero, column);
  const double chord = std::hypot(end.x - start.x, end.y - start.y);
  if (chord == 0.0) fail(Fault::arc_full_by_radius, column, {r_word()});
  Point centre;
  if (!centre_by_radius(start, end, r, counter_clockwise, centre))
    fail(Fault::arc_too_small, column, {text::number(r, 4), text::number(chord, 4), r_word()});
  return centre;
}

/// Length of a circular motion with all that moves beside it.
double Motion::helix_length(const Arc& arc, double radius) const {
  double square = std::pow(arc.sweep_deg * kDegree * radius, 2);
  for (int a = 0; a < machine_.axis_count(); ++a)
    if (a != arc.axis1 && a != arc.axis2) square += std::pow(arc.to[at(a)] - at_.machine[at(a)], 2);
  return std::sqrt(square);
}

/// Centre by its words in machine coordinates: absolute in the origin, or from the start.
Point Motion::arc_centre(const BlockWords& words) const {
  const int a1 = at_.axis1, a2 = at_.axis2;
  const Frame& frame = at_.frame;
  const auto written = [&](int axis, const Word* word) {
    return word == nullptr ? 0.0 : numbers_.length(axis, word->value, dialect_.centre_as_diameter);
  };
  const double i = written(a1, words.centre1), j = written(a2, words.centre2);
  if (words.machine_zero && dialect_.arc_centre == ArcCentre::as_dimensions)
    return {i + frame.length(a1), j + frame.length(a2)};
  const auto from_start = [&](const Word* word) {
    if (word != nullptr && word->value.dimension != Dimension::as_modes)
      return word->value.dimension == Dimension::incremental;
    return modes_.dimension == Function::incremental || dialect_.arc_centre != ArcCentre::as_dimensions;
  };
  Position centre{};
  centre[at(a1)] = i + (from_start(words.centre1) ? frame.to_programmed(at_.machine, a1) : 0.0);
  centre[at(a2)] = j + (from_start(words.centre2) ? frame.to_programmed(at_.machine, a2) : 0.0);
  return {frame.to_machine(centre, a1), frame.to_machine(centre, a2)};
}

/// Whole turns beyond the programmed arc: the total angle is 360 degrees times depth over pitch.
/// Source: specification A 9.4, A 24 decision 20.
double Motion::helix_turns(const BlockWords& words, const Position& to, double sweep_deg,
                           double radius) const {
  if (words.pitch == nullptr) return 0.0;
  int axis = at_.normal;
  if (axis < 0 || words.axis[at(axis)] == nullptr)
    for (int a = 0; a < machine_.axis_count(); ++a)
      if (words.axis[at(a)] != nullptr && a != at_.axis1 && a != at_.axis2) axis = a;
  const int column = words.pitch->column;
  if (axis < 0 || words.axis[at(axis)] == nullptr) fail(Fault::helix_axis, column, {letter(Meaning::pitch)});
  const double pitch = numbers_.length(axis, words.pitch->value) * std::abs(at_.frame.scale(axis));
  if (pitch <= 0.0)
    fail(Fault::helix_pitch, words.pitch->value.column, {text::number(pitch, 4), letter(Meaning::pitch)});
  const double total = 360.0 * std::abs(to[at(axis)] - at_.machine[at(axis)]) / pitch;
  const double turns = std::max(0.0, std::round((total - std::abs(sweep_deg)) / 360.0));
  if (turns > kMaxTurns) fail(Fault::helix_long, column, {text::number(turns, 0), text::number(kMaxTurns)});
  const double slack = kRadiusTolerance / radius / kDegree + 1e-6;
  if (std::abs(total - std::abs(sweep_deg) - 360.0 * turns) > slack)
    fail(Fault::helix_mismatch, column, {text::number(total, 3), text::number(std::abs(sweep_deg), 3)});
  return turns;
}

}  // namespace servogate::program
