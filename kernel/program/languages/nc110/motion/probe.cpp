// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/motion/motion.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"

/// G72, G73, G74: the motions of a measurement as commands, and its results. Where nothing is driven a
/// parameter has what a part without any error would give. Touches are those of the ball's centre. Source:
/// specification A 18, B 10.
namespace servogate::program::nc110 {
namespace {

constexpr int kMostAxes = 3;

std::size_t index(int axis) { return static_cast<std::size_t>(axis); }

/// First parameter that takes a result.
int first_result(const Execution& run, const BlockWords& words) {
  if (words.amount == nullptr) fail(Wrong::probe_result, words.instead_word->column);
  const int first = run.numbers().whole(words.amount->value, "E");
  if (first < run.dialect().parameters.first_real) fail(Wrong::probe_result, words.amount->column);
  return first;
}

void check_block(const Execution& run, const BlockWords& words) {
  const int column = words.instead_word->column;
  if (run.contour().engaged() || run.state().profile.open)
    fail(Fault::contour_excludes, column, {word_text(run.dialect(), run.block(), *words.instead_word)});
  if (run.state().own[at(Own::probe_feed)] <= 0.0) fail(Wrong::probe_no_parameters, column);
  for (const Word* word : {words.centre1, words.centre2, words.pitch, words.feed, words.time, words.radius2})
    if (word != nullptr)
      fail(Fault::word_without_function, word->column, {word_text(run.dialect(), run.block(), *word)});
}

ProbingState& begin(Execution& run, int first, int column, std::size_t touches) {
  ProbingState& probing = run.state().probing;
  probing = {};
  probing.expected = touches;
  probing.first = first;
  probing.column = column;
  return probing;
}

/// As programs write it: programmed coordinate, diameter, unit.
double shown(const Execution& run, double programmed, int axis) {
  return programmed * (run.machine().axes[index(axis)].diameter ? 2.0 : 1.0) /
         run.numbers().unit_factor(axis);
}

/// At rapid to the approach point, at the measuring feed beyond the nominal one, at rapid back.
void measure(Execution& run, const Position& nominal) {
  FramesState& frames = run.state().frames;
  const auto& own = run.state().own;
  const Position start = frames.machine;
  double way = 0.0;
  for (std::size_t a = 0; a < start.size(); ++a) way += std::pow(nominal[a] - start[a], 2);
  way = std::sqrt(way);
  if (way <= 0.0) fail(Wrong::probe_no_way, static_cast<int>(run.block().body) + 1);
  const auto beyond = [&](double distance) {
    Position to = start;
    for (std::size_t a = 0; a < start.size(); ++a)
      to[a] = nominal[a] + (nominal[a] - start[a]) / way * distance;
    for (int a = 0; a < run.machine().axis_count(); ++a)
      run.frames().check_axis(a, to[index(a)], column_of(run.block(), a));
    return to;
  };
  if (own[at(Own::approach)] < way) run.emit(Rapid{beyond(-own[at(Own::approach)])});
  run.emit(Probe{beyond(own[at(Own::safety)]), own[at(Own::probe_feed)]});
  run.emit(Rapid{start});
}

void store(Execution& run, int parameter, double value, int column) {
  run.state().parameters.set(parameter, value, column);
  run.state().flow.barrier = true;
  run.depends_on_machine();
}

void take_axes(Execution& run) {
  const ProbingState probing = run.state().probing;
  const Position& touch = probing.touches.front();
  for (std::size_t i = 0; i < probing.count; ++i) {
    const int axis = probing.axes[i];
    const double at = run.state().frames.frame.to_programmed(touch, axis);
    const double value = probing.deviations ? at - probing.nominal[index(axis)] : at;
    store(run, probing.first + static_cast<int>(i), shown(run, value, axis), probing.column);
  }
}

/// Centre and radius of the circle that the centre of the ball has touched.
void take_hole(Execution& run) {
  const ProbingState probing = run.state().probing;
  const Frame& frame = run.state().frames.frame;
  const int axis1 = probing.axes[0], axis2 = probing.axes[1];
  const auto at = [&](std::size_t touch, int axis) {
    return frame.to_programmed(probing.touches[touch], axis);
  };
  const double unit = run.numbers().unit_factor(axis1);
  store(run, probing.first, 0.5 * (at(0, axis1) + at(1, axis1)) / unit, probing.column);
  store(run, probing.first + 1, 0.5 * (at(2, axis2) + at(3, axis2)) / unit, probing.column);
  const double radius =
      0.25 * (std::abs(at(0, axis1) - at(1, axis1)) + std::abs(at(2, axis2) - at(3, axis2)));
  store(run, probing.first + 2, radius / unit, probing.column);
}

/// The axes of the block in the order written.
int written_axes(const Execution& run, std::array<const Word*, kMostAxes>& axes) {
  const Block& block = run.block();
  int count = 0;
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.meaning != Meaning::axis) continue;
    if (count == kMostAxes) fail(Wrong::probe_axes, word.column, {std::to_string(kMostAxes)});
    axes[static_cast<std::size_t>(count++)] = &word;
  }
  return count;
}

void measure_axes(Execution& run, const BlockWords& words, bool deviations) {
  check_block(run, words);
  const int first = first_result(run, words);
  std::array<const Word*, kMostAxes> axes{};
  const int count = written_axes(run, axes);
  if (count == 0) fail(Wrong::probe_no_way, words.instead_word->column);
  const Position stands = run.state().frames.programmed;
  const Position nominal = run.motion().target_of(words);
  const Position programmed = run.state().frames.programmed;
  run.state().frames.programmed = stands;
  measure(run, nominal);
  ProbingState& probing = begin(run, first, words.amount->column, 1);
  probing.take = take_axes;
  probing.nominal = programmed;
  probing.deviations = deviations;
  for (int i = 0; i < count; ++i) {
    const int axis = axes[static_cast<std::size_t>(i)]->axis;
    probing.axes[probing.count++] = axis;
    store(run, first + i, deviations ? 0.0 : shown(run, programmed[index(axis)], axis), words.amount->column);
  }
}

}  // namespace

void read_result(BlockText& text, Word& word) {
  const std::size_t start = word.column - 1u;
  const auto measures = [](const Word& g) {
    return g.meaning == Meaning::g && (g.g == nullptr || (g.g->number >= 72 && g.g->number <= 74));
  };
  const auto words = text.block.words.begin();
  std::size_t end = text.pos;
  while (end < text.line.size() && is_digit(text.line[end])) ++end;
  if (!std::any_of(words, words + text.block.count, measures))
    fail(Fault::unknown_word, word.column, {std::string(text.line.substr(start, end - start)), {}});
  word.value = read_value(text, "E");
  if (word.value.bare || word.value.fraction || word.value.negative) fail(Wrong::probe_result, word.column);
}

void probe_point(Execution& run, const BlockWords& words) { measure_axes(run, words, false); }
void probe_deviation(Execution& run, const BlockWords& words) { measure_axes(run, words, true); }

/// Four touches from the centre along the axes of the plane.
void probe_hole(Execution& run, const BlockWords& words) {
  check_block(run, words);
  const int first = first_result(run, words);
  const Word* word = words.angle != nullptr ? words.angle : words.radius;
  run.frames().need_plane(words.instead_word->column);
  const FramesState& frames = run.state().frames;
  for (const Word* axis : words.axis)
    if (axis != nullptr)
      fail(Fault::word_without_function, axis->column, {word_text(run.dialect(), run.block(), *axis)});
  const double radius = word == nullptr ? 0.0 : run.numbers().length(frames.axis1, word->value, false);
  if (!(radius > 0.0)) fail(Wrong::probe_radius, words.instead_word->column);
  const Position centre = frames.machine;
  for (const int axis : {frames.axis1, frames.axis2})
    for (const double sign : {1.0, -1.0}) {
      Position nominal = centre;
      nominal[index(axis)] += sign * radius;
      measure(run, nominal);
    }
  ProbingState& probing = begin(run, first, words.amount->column, 4);
  probing.take = take_hole;
  probing.axes = {frames.axis1, frames.axis2, 0};
  const double unit = run.numbers().unit_factor(frames.axis1);
  store(run, first, frames.programmed[index(frames.axis1)] / unit, words.amount->column);
  store(run, first + 1, frames.programmed[index(frames.axis2)] / unit, words.amount->column);
  store(run, first + 2, radius / unit, words.amount->column);
}

}  // namespace servogate::program::nc110
