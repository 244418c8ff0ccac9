// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/arguments.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

/// Modes with arguments: chip breaking, cutting speed, corrector on and off, homing (specification 10, 11,
/// 14, 15).
namespace servogate::program::fenix {
namespace {

double& own(State& state, Own which) { return state.own[static_cast<std::size_t>(which)]; }
double own(const State& state, Own which) { return state.own[static_cast<std::size_t>(which)]; }

void within(const char* name, double value, double least, double most, int column) {
  if (!(value >= least && value <= most))
    fail(Fault::out_of_range, column, {name, text::number(value), text::number(least), text::number(most)});
}

constexpr double kFirstPass = 5.0;   ///< mm, until a program says another one
constexpr double kBreakDwell = 100;  ///< ms

}  // namespace

ChipBreaking chips(const State& state) {
  return {own(state, Own::breaks) != 0.0, own(state, Own::break_last) != 0.0,
          own(state, Own::pass_set) != 0.0 ? own(state, Own::pass) : kFirstPass, own(state, Own::back),
          (own(state, Own::pass_set) != 0.0 ? own(state, Own::dwell) : kBreakDwell) / 1000.0};
}

void clearance(Execution&, double value, int, int column) { within("P404", value, 0.0, 1000.0, column); }
void deviation(Execution&, double value, int, int column) { within("P2622", value, 0.0, 99.0, column); }

/// Pass and retract that are left out keep their values, the dwell does not.
void break_chips(Execution& run, BlockWords&, const Word& word) {
  const Arguments arguments(run, word);
  arguments.at_most(4);
  State& state = run.state();
  const ChipBreaking before = chips(state);
  own(state, Own::pass) = arguments.positive(0, before.pass, true);
  own(state, Own::back) = arguments.positive(1, before.back);
  own(state, Own::break_last) = arguments.number(2, before.last ? 1.0 : 0.0) != 0.0 ? 1.0 : 0.0;
  own(state, Own::dwell) = arguments.positive(3, kBreakDwell);
  own(state, Own::breaks) = own(state, Own::pass_set) = 1.0;
}

void keep_chips(Execution& run, BlockWords&, const Word&) { own(run.state(), Own::breaks) = 0.0; }

/// G96 brings the feed per revolution along. Its upper limit goes with the speed; a lower one that asks for
/// more than the spindle's own is not kept, and is refused.
void cutting_speed(Execution& run, BlockWords& words, const Word& word) {
  const Arguments arguments(run, word);
  arguments.at_most(2);
  State& state = run.state();
  const double least = arguments.number(0, own(state, Own::least_rpm));
  const double most = arguments.number(1, state.motion.limit_rpm);
  if (least < 0.0 || most < 0.0 || (most > 0.0 && most < least))
    fail(Wrong::cutting_limits, word.column, {text::number(least), text::number(most)});
  if (least > run.machine().spindle_min_rpm && least > 0.0)
    fail(Wrong::least_speed, word.column, {text::number(least)});
  own(state, Own::least_rpm) = least;
  state.motion.limit_rpm = most;
  state.modes.feed = Function::feed_revolution;
  words.one_shot |= std::uint64_t{1} << static_cast<int>(Function::feed_revolution);
}

/// A feed per minute ends the cutting speed; the spindle keeps what it has then.
void feed_per_minute(Execution& run, BlockWords& words, const Word&) {
  if (run.state().modes.spindle != Function::surface_speed) return;
  run.state().modes.spindle = Function::revolutions;
  words.one_shot |= std::uint64_t{1} << static_cast<int>(Function::revolutions);
}

void corrector_on(Execution& run, BlockWords&, const Word&) {
  run.state().frames.lengths_off = false;
  run.frames().use_lengths(run.state().frames.corrector);
}

void corrector_off(Execution& run, BlockWords&, const Word&) {
  run.state().frames.lengths_off = true;
  run.frames().use_lengths(run.state().frames.corrector);
}

/// The axes have been homed before a program may start: they go to their zero marks, all together, whatever
/// their words say.
void home(Execution& run, const BlockWords& words) {
  run.refuse_words_but_axes(words);
  run.motion().store_feed(words);
  if (words.axes == 0)
    fail(Wrong::cycle_axis, words.instead_word->column, {"G30", text::both("an axis", "ось")});
  Position to = run.state().frames.machine;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axis[static_cast<std::size_t>(a)] != nullptr)
      to[static_cast<std::size_t>(a)] = run.machine().axes[static_cast<std::size_t>(a)].reference;
  run.motion().rapid_to(to);
}

void as_motion(Execution&, BlockWords& words, const Word&) { words.counts_as_motion = true; }

/// By an angle with its sign, + clockwise, at S; the spindle stands oriented before (specification 16).
void turn_spindle(Execution& run, const BlockWords& words) {
  constexpr double kMost = 3'600'000.0;  // degrees
  const Arguments arguments(run, words);
  run.refuse_all_but(words, {});
  arguments.at_most(1);
  const double degrees = arguments.required(0);
  const State& state = run.state();
  if (std::abs(degrees) > kMost)
    fail(Wrong::argument_angle, arguments.column(),
         {arguments.name(), "0", text::number(degrees), text::number(-kMost), text::number(kMost)});
  if (run.machine().spindles == 0) fail(Fault::no_spindle, arguments.column(), {arguments.name()});
  if (state.motion.spindle != SpindleMode::orient && state.motion.spindle != SpindleMode::turn)
    fail(Wrong::spindle_free, arguments.column(), {arguments.name()});
  if (state.modes.cutting || state.modes.speed <= 0.0)
    fail(Wrong::spindle_speed, arguments.column(), {arguments.name()});
  run.motion().turn_spindle_by(degrees);
}

}  // namespace servogate::program::fenix
