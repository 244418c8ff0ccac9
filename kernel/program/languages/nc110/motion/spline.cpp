// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/spline.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"

/// Splines: BSP, an entry motion, points from G06 on, an exit motion, ESP. Source: specification A 11.
namespace servogate::program::nc110 {
namespace {

constexpr std::size_t kMostPoints = 2'000;
constexpr double kTolerance = 0.0005;  ///< mm that chords leave the curve by
constexpr double kSame = 1e-6;

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }
int here(const Execution& run) { return static_cast<int>(run.block().body) + 1; }

double distance(const Position& a, const Position& b, int axes) {
  double square = 0.0;
  for (int i = 0; i < axes; ++i) square += std::pow(a[at(i)] - b[at(i)], 2);
  return std::sqrt(square);
}

/// Unit direction of a motion, none where it does not move.
std::optional<Position> direction(const Execution& run, const Position& from, const Position& to) {
  const double way = distance(from, to, run.machine().axis_count());
  if (way < kSame) fail(Wrong::spline_direction, here(run));
  Position out{};
  for (int i = 0; i < run.machine().axis_count(); ++i) out[at(i)] = (to[at(i)] - from[at(i)]) / way;
  return out;
}

void give_part(Execution& run, const SplineState::Knot& knot, const Position& from, const Position& to) {
  const FramesState& frames = run.state().frames;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    run.frames().check_axis(a, to[at(a)], knot.place.column);
  ContourElement e;
  e.in_plane = true;
  e.start = {from[at(frames.axis1)], from[at(frames.axis2)]};
  e.end = {to[at(frames.axis1)], to[at(frames.axis2)]};
  e.to = to;
  e.feed = knot.feed;
  e.corner = knot.corner;
  e.place = knot.place;
  run.contour().take(std::move(e));
  run.state().frames.machine = to;
}

/// All of the curve, as chords.
void give_curve(Execution& run, const std::optional<Position>& last) {
  SplineState& state = run.state().spline;
  std::vector<Position> points;
  for (const auto& knot : state.knots) points.push_back(knot.at);
  const auto axes = static_cast<std::size_t>(run.machine().axis_count());
  const Spline curve(std::move(points), axes, state.first, last);
  Position from = state.knots.front().at;
  run.state().frames.machine = from;
  for (std::size_t span = 0; span < curve.spans(); ++span) {
    const SplineState::Knot& knot = state.knots[span + 1];
    const int parts = curve.parts(span, kTolerance);
    for (int part = 1; part <= parts; ++part) {
      Position to = knot.at;
      if (part < parts) {
        const Position point = curve.at(span, static_cast<double>(part) / parts);
        std::copy(point.begin(), point.begin() + static_cast<std::ptrdiff_t>(axes), to.begin());
      }
      give_part(run, knot, from, to);
      from = to;
    }
  }
}

[[noreturn]] void wrong_motion(const Execution& run) { fail(Wrong::spline_motion, here(run)); }

}  // namespace

namespace code {

void bsp(Execution& run, const Operands& operands) {
  SplineState& state = run.state().spline;
  const FramesState& frames = run.state().frames;
  if (state.phase != SplineState::Phase::none) fail(Wrong::spline_motion, operands.column);
  if (operands.items[0].axis != frames.axis1 || operands.items[1].axis != frames.axis2)
    fail(Wrong::spline_plane, static_cast<int>(operands.items[0].begin) + 1);
  const int ends = run.numbers().whole(operands.items[2].value, "BSP");
  if (ends > 3) fail(Wrong::spline_ends, operands.items[2].value.column);
  state = SplineState{};
  state.phase = SplineState::Phase::entry;
  state.ends = ends;
}

void esp(Execution& run, const Operands& operands) {
  if (run.state().spline.phase != SplineState::Phase::left) fail(Wrong::spline_motion, operands.column);
  run.state().spline = SplineState{};
}

}  // namespace code

/// A motion block while a spline is open.
void spline(Execution& run, const BlockWords& words) {
  State& state = run.state();
  SplineState& spline = state.spline;
  const Function motion = state.modes.motion;
  const bool straight = motion == Function::rapid || motion == Function::line;
  if (spline.phase == SplineState::Phase::points && motion == Function::spline)
    for (const Word* word : {words.speed, words.tool, words.h, words.m[0]})
      if (word != nullptr)
        fail(Wrong::spline_function, word->column, {word_text(run.dialect(), run.block(), *word)});
  switch (spline.phase) {
    case SplineState::Phase::entry: {
      if (!straight) wrong_motion(run);
      const Position from = state.frames.machine;
      run.motion().move(words);
      if (spline.ends == 1 || spline.ends == 3) spline.first = direction(run, from, state.frames.machine);
      spline.knots.push_back(
          {state.frames.machine, {}, {}, run.contour().place(here(run), run.block().number)});
      spline.phase = SplineState::Phase::points;
      return;
    }
    case SplineState::Phase::points: {
      if (motion == Function::spline) {
        if (spline.knots.size() == kMostPoints)
          fail(Wrong::spline_long, here(run), {std::to_string(kMostPoints)});
        SplineState::Knot knot{run.motion().target_of(words), run.motion().feed(words),
                               run.motion().corner_of(words),
                               run.contour().place(here(run), run.block().number)};
        if (distance(knot.at, spline.knots.back().at, run.machine().axis_count()) < kSame)
          fail(Wrong::spline_double, here(run));
        state.frames.machine = knot.at;
        spline.knots.push_back(std::move(knot));
        return;
      }
      if (!straight || spline.knots.size() < 2) wrong_motion(run);
      const Position programmed = state.frames.programmed;
      const Position to = run.motion().target_of(words);
      state.frames.programmed = programmed;
      std::optional<Position> last;
      if (spline.ends >= 2) last = direction(run, spline.knots.back().at, to);
      give_curve(run, last);
      spline.phase = SplineState::Phase::left;
      run.motion().move(words);
      return;
    }
    default:
      wrong_motion(run);
  }
}

}  // namespace servogate::program::nc110
