// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "kernel/program/cycles/boring.hpp"
#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/arguments.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

/// G81, G810 to G812 and G820 to G826 (specification 17, 19, 20).
namespace servogate::program::fenix {
namespace {

std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

constexpr int kNone = -1;

/// Which argument of a cycle is what; P0 is the level of approach and P1 the depth in all of them.
struct Row {
  int number, most;
  bool stops = false;  ///< the spindle stands while the tool leaves
  int retreat = kNone, shift = kNone, first = kNone, next = kNone, feed = kNone, back_feed = kNone,
      rpm = kNone, back_rpm = kNone, dwell_pass = kNone, dwell_bottom = kNone, dwell_out = kNone;
  double bottom_ms = 0.0;                                                ///< where that dwell is left out
  int end = kNone, step = kNone, allowance = kNone, last_shift = kNone;  ///< of passes in X
};
constexpr Row kRows[] = {
    {.number = 81, .most = 5, .retreat = 2, .first = 4},
    {.number = 810, .most = 6, .retreat = 2, .first = 4, .feed = 5},
    {.number = 811, .most = 6, .retreat = 2, .first = 4, .feed = 5, .dwell_bottom = 3, .bottom_ms = 10.0},
    {.number = 812,
     .most = 9,
     .retreat = 2,
     .first = 4,
     .next = 5,
     .feed = 7,
     .dwell_pass = 3,
     .dwell_bottom = 8,
     .dwell_out = 6},
    {.number = 820,
     .most = 10,
     .retreat = 2,
     .shift = 3,
     .first = 4,
     .feed = 5,
     .back_feed = 6,
     .rpm = 7,
     .back_rpm = 8,
     .dwell_bottom = 9},
    {.number = 821,
     .most = 10,
     .stops = true,
     .retreat = 2,
     .shift = 3,
     .first = 4,
     .feed = 5,
     .back_feed = 6,
     .rpm = 7,
     .dwell_bottom = 9},
    {.number = 822,
     .most = 13,
     .retreat = 2,
     .shift = 3,
     .first = 4,
     .next = 5,
     .feed = 7,
     .back_feed = 8,
     .rpm = 9,
     .back_rpm = 10,
     .dwell_pass = 11,
     .dwell_bottom = 12,
     .dwell_out = 6},
    {.number = 823,
     .most = 13,
     .stops = true,
     .retreat = 2,
     .shift = 3,
     .first = 4,
     .next = 5,
     .feed = 7,
     .back_feed = 8,
     .rpm = 9,
     .dwell_pass = 11,
     .dwell_bottom = 12,
     .dwell_out = 6},
    {.number = 824,
     .most = 15,
     .retreat = 7,
     .shift = 5,
     .first = 8,
     .feed = 10,
     .back_feed = 11,
     .rpm = 12,
     .back_rpm = 13,
     .dwell_bottom = 14,
     .dwell_out = 9,
     .end = 2,
     .step = 3,
     .allowance = 4,
     .last_shift = 6},
    {.number = 825,
     .most = 15,
     .stops = true,
     .retreat = 7,
     .shift = 5,
     .first = 8,
     .feed = 10,
     .back_feed = 11,
     .rpm = 12,
     .dwell_bottom = 14,
     .dwell_out = 9,
     .end = 2,
     .step = 3,
     .allowance = 4,
     .last_shift = 6},
    {.number = 826,
     .most = 16,
     .retreat = 7,
     .shift = 5,
     .first = 8,
     .next = 9,
     .feed = 11,
     .back_feed = 12,
     .rpm = 13,
     .back_rpm = 14,
     .dwell_pass = 15,
     .dwell_bottom = 15,
     .dwell_out = 10,
     .end = 2,
     .step = 3,
     .allowance = 4,
     .last_shift = 6},
};

const Row& row_of(int number) {
  return *std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.number == number; });
}

constexpr double kFirstDepth = 1.0;    ///< mm of a pass that is left out
constexpr double kDiameterStep = 2.0;  ///< the same in X
constexpr int kMostPasses = 10'000;

/// A coordinate or length of X, as its words count at this place.
double across(const Execution& run, int axis, double value) {
  const bool diameter =
      run.machine().axes[at(axis)].diameter && run.state().modes.across == Function::diameter;
  return diameter ? value / 2.0 : value;
}

Boring hole_of(const Execution& run, const Arguments& arguments, const Row& row) {
  Boring hole;
  hole.name = arguments.name();
  hole.axis = run.state().frames.axis1;
  hole.approach = arguments.required(0);
  hole.depth = arguments.required(1);
  hole.retreat = arguments.number_or(row.retreat, hole.approach);
  hole.chips = chips(run.state());
  if (row.next != kNone) {
    hole.first = arguments.positive(row.first, kFirstDepth, true);
    hole.next = arguments.positive(row.next, kFirstDepth, true);
    hole.reentry = std::abs(run.machine().variable("P404", 1.0));
    hole.chips.on = false;
  } else if (arguments.given(row.first)) {
    hole.first = arguments.positive(row.first, 0.0);
  }
  hole.feed = arguments.positive(row.feed, 0.0);
  hole.back_feed = arguments.positive(row.back_feed, 0.0);
  hole.rpm = arguments.positive(row.rpm, 0.0);
  hole.back_rpm = arguments.positive(row.back_rpm, hole.rpm);
  hole.stops = row.stops || (row.number == 826 && !arguments.given(row.back_rpm));
  hole.dwell_pass_s = arguments.positive(row.dwell_pass, 0.0) / 1000.0;
  hole.dwell_bottom_s =
      arguments.positive(row.dwell_bottom, row.bottom_ms > 0.0 ? row.bottom_ms : hole.dwell_pass_s * 1000.0) /
      1000.0;
  hole.dwell_out_s = arguments.positive(row.dwell_out, 0.0) / 1000.0;
  if (row.shift != kNone && run.state().frames.axis2 >= 0) {
    hole.shift_axis = run.state().frames.axis2;
    hole.shift = across(run, hole.shift_axis, arguments.number(row.shift));
  }
  return hole;
}

/// Passes in X up to the last one, which takes what the allowance leaves.
void widen(Execution& run, const Arguments& arguments, const Row& row, const Boring& hole) {
  const int x = run.state().frames.axis2;
  const double begin = run.state().frames.programmed[at(x)];
  const double end = across(run, x, arguments.required(row.end));
  const double step = across(run, x, arguments.positive(row.step, kDiameterStep, true));
  const double allowance = across(run, x, arguments.positive(row.allowance, 0.0));
  const double way = end - begin, out = way < 0.0 ? -1.0 : 1.0;
  if (std::abs(way) / step > kMostPasses)
    fail(Wrong::passes, arguments.column(), {hole.name, std::to_string(kMostPasses)});
  const double rough = end - out * std::min(allowance, std::abs(way));
  double at_x = begin;
  while (at_x != end) {
    const double next = at_x + out * step;
    if ((rough - at_x) * out > 1e-9)
      at_x = (rough - next) * out > 1e-9 ? next : rough;
    else
      at_x = end;
    Boring pass = hole;
    if (at_x == end)
      pass.shift = across(run, x, arguments.number(row.last_shift));
    else
      pass.retreat = hole.approach;
    run.motion().go(x, at_x, true);
    bore(run, pass);
    if (at_x != end && hole.next <= 0.0 && hole.dwell_out_s > 0.0) run.motion().dwell(hole.dwell_out_s);
  }
}

}  // namespace

void holes(Execution& run, const BlockWords& words) {
  const Arguments arguments(run, words);
  const Row& row = row_of(static_cast<int>(words.instead_word->value.number));
  run.frames().need_plane(arguments.column());
  run.refuse_all_but(words, {});
  run.motion().end_profile();
  forget_profile(run.state());
  arguments.at_most(row.most);
  Boring hole = hole_of(run, arguments, row);
  hole.only_down = row.number == 81;
  if (row.end != kNone) return widen(run, arguments, row, hole);
  bore(run, hole);
}

}  // namespace servogate::program::fenix
