// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

namespace servogate::program::sinumerik::iso {

void to_siemens(Execution& run, const BlockWords& words) {
  for (std::size_t i = 0; i < run.block().count; ++i)
    if (&run.block().words[i] != words.instead_word)
      fail(Wrong::switch_alone, run.block().words[i].column, {"G290"});
  run.motion().end_profile();
  run.state().modes.override_effective = true;
  arrange_override(run);
  run.state().frames.lengths_by_language = false;
  run.speak(sinumerik::dialect());
}

void ignored(Execution&, const BlockWords&) {}

/// G08 P1 and P0: the path is looked ahead on in either case.
void look_ahead(Execution& run, const BlockWords& words) {
  only(run, "P");
  if (const int p = whole(run, 'P', 1); p > 1)
    fail(Wrong::letter_range, column(words), {"G08", "P", std::to_string(p), "0, 1"});
}

void path_mode(Execution& run, BlockWords&, const Word&) { run.state().modes.override_effective = true; }
void tapping_mode(Execution& run, BlockWords&, const Word&) { run.state().modes.override_effective = false; }

/// The machine is told where it does not know yet.
void arrange_override(Execution& run) {
  State& state = run.state();
  const bool effective = state.modes.override_effective;
  if (effective == (value(state, own::override_told) == 0.0)) return;
  value(state, own::override_told) = effective ? 0.0 : 1.0;
  run.motion().end_profile();
  run.emit(FeedOverride{effective});
}

void another_feed(Execution& run, BlockWords& words, const Word& word) { new_feed(run, words, word); }

/// Ends what lasts of the cycles.
void plain_motion(Execution& run, BlockWords&, const Word&) {
  value(run.state(), own::turning_cycle) = 0.0;
  value(run.state(), own::hole) = 0.0;
}

void to_initial(Execution& run, BlockWords&, const Word&) { value(run.state(), own::to_r) = 0.0; }
void to_level(Execution& run, BlockWords&, const Word&) { value(run.state(), own::to_r) = 1.0; }

void thread_constant(Execution& run, BlockWords& words, const Word& word) {
  plain_motion(run, words, word);
  value(run.state(), own::variable_lead) = 0.0;
}
void thread_variable(Execution& run, BlockWords& words, const Word& word) {
  plain_motion(run, words, word);
  value(run.state(), own::variable_lead) = 1.0;
}

void spindle_dwell(Execution& run, double rotations, int column) {
  const Modes& modes = run.state().modes;
  if (modes.cutting || modes.speed <= 0.0) fail(Wrong::dwell_spindle, column, {"G04"});
  run.motion().dwell(rotations * 60.0 / modes.speed);
}

/// X and U in s, with MD20734 bit 2 and a feed per revolution in turns of the spindle; P in thousandths.
void dwell(Execution& run, const BlockWords& words) {
  constexpr double kMost = 99'999.999;
  only(run, "XUP");
  const Word* time = nullptr;
  for (const char letter : {'X', 'U', 'P'})
    if (const Word* word = find(run.block(), letter); word != nullptr) {
      if (time != nullptr) fail(Wrong::dwell_time, word->column, {g_word(run, words)});
      time = word;
    }
  if (time == nullptr) fail(Wrong::letter_missing, column(words), {g_word(run, words), "X"});
  const bool thousandths = time->letter == 'P' || (!time->value.fraction && setting(run, "MD10884") == 0.0);
  const double amount = run.numbers().resolve(time->value) * (thousandths ? 0.001 : 1.0);
  if (!(amount >= 0.0 && amount <= kMost))
    fail(Fault::out_of_range, time->column,
         {std::string(1, time->letter), text::number(amount), "0", text::number(kMost)});
  const bool turns = bit(run, 2) && run.state().modes.feed == Function::feed_revolution;
  turns ? spindle_dwell(run, amount, time->column) : run.motion().dwell(amount);
}

namespace {

double longest_way(const Execution& run, const Position& to) {
  double longest = 0.0;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    longest = std::max(longest, std::abs(to[at(a)] - run.state().frames.machine[at(a)]));
  return longest;
}

}  // namespace

double start_angle(Execution& run) {
  State& state = run.state();
  const Word* q = find(run.block(), 'Q');
  if (q == nullptr)
    return value(state, own::start_angle_set) != 0.0 ? value(state, own::start_angle)
                                                     : setting(run, "SD42000");
  double angle = run.numbers().resolve(q->value);
  if (!q->value.fraction && setting(run, "MD10884") == 0.0) angle *= 0.001;
  if (!(angle >= 0.0 && angle < 360.0))
    fail(Fault::out_of_range, q->column, {"Q", text::number(angle), "0", "359.999"});
  value(state, own::start_angle) = angle;
  value(state, own::start_angle_set) = 1.0;
  return angle;
}

/// G32 and G34: the lead counts along the axis with the longer way, X as a radius (specification 7).
void thread(Execution& run, const BlockWords& words) {
  const int place = static_cast<int>(run.block().body) + 1;
  const bool variable = value(run.state(), own::variable_lead) != 0.0;
  const std::string name = variable ? "G34" : "G32";
  only(run, variable ? "XYZABCUVWHFKQMST" : "XYZABCUVWHFQMST");
  if (run.machine().spindles == 0) fail(Fault::no_spindle, place, {name});
  if (run.contour().engaged()) fail(Wrong::compensated, place, {name, "G41/G42"});
  Thread cut;
  cut.lead = run.state().motion.feed * (run.state().modes.unit == Function::inch ? 25.4 : 1.0);
  if (!(cut.lead > 0.0)) fail(Wrong::thread_lead, place, {name});
  const Word* k = find(run.block(), 'K');
  if (variable && k == nullptr) fail(Wrong::letter_missing, place, {name, "K"});
  if (variable) cut.lead_change = length(run, *k);
  cut.start_angle_deg = start_angle(run);
  cut.to = run.motion().target_of(words);
  const double way = longest_way(run, cut.to);
  if (cut.lead * cut.lead + 2.0 * cut.lead_change * way < 0.0)
    fail(Wrong::thread_ends, k->column, {name, text::number(-cut.lead * cut.lead / (2.0 * way), 4)});
  run.motion().thread(cut);
}

namespace {

void keep_measured(Execution& run) {
  State& state = run.state();
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    state.own[own::measured_machine + at(a)] = state.frames.machine[at(a)];
    state.own[own::measured_work + at(a)] = state.frames.programmed[at(a)];
  }
}

/// Increments of the next block count from the touch, not from where the axes rest.
void take_touch(Execution& run) {
  run.state().frames.machine = run.state().probing.touches.front();
  run.frames().changed();
  keep_measured(run);
}

}  // namespace

/// G31: what the probe finds is known when the motion has ended (specification 15).
void measure(Execution& run, const BlockWords& words) {
  run.refuse_words_but_axes(words);
  run.motion().store_feed(words);
  const int place = column(words);
  if (run.contour().engaged() || run.state().modes.compensation != Function::compensation_off)
    fail(Wrong::compensated, place, {"G31", "G41/G42"});
  if (words.axes == 0) fail(Wrong::axis_alone, place, {"G31"});
  State& state = run.state();
  run.motion().end_profile();
  const Position to = run.motion().target_of(words);
  const Feed feed = run.motion().feed(words);
  const double per_minute = feed.unit == FeedUnit::mm_per_rev ? feed.value * state.modes.speed : feed.value;
  run.emit(Probe{to, per_minute});
  state.frames.machine = to;
  keep_measured(run);
  state.probing = {};
  state.probing.expected = 1;
  state.probing.take = take_touch;
  state.flow.barrier = true;
  run.depends_on_machine();
}

namespace {

constexpr int kTypes = 1000, kAll = 1001, kWork = 2000, kMachine = 3000;

double mask(const State& state, std::size_t first) {
  double bits = 0.0;
  for (std::size_t i = 0; i < 26; ++i)
    if (state.own[first + i] != 0.0) bits += std::ldexp(1.0, static_cast<int>(i));
  return bits;
}

}  // namespace

double system_value(const Execution& run, int number, int column) {
  const State& state = run.state();
  if (number == kTypes) return mask(state, own::argument_real);
  if (number == kAll) return mask(state, own::argument_set);
  if (number < kWork) return state.own[static_cast<std::size_t>(number)];
  const char letter = static_cast<char>(number % kTypes);
  const int axis = run.axes().find(letter);
  if (axis < 0) fail(Fault::axis_missing, column, {std::string(1, letter)});
  const double value =
      state.own[(number >= kMachine ? own::measured_machine : own::measured_work) + at(axis)];
  return run.machine().axes[at(axis)].diameter ? 2.0 * value : value;
}

int system_number(std::string_view name, int index) {
  const auto letter = [&](std::size_t i) { return static_cast<std::size_t>(name[i] - 'A'); };
  const auto of_ijk = [&](std::size_t first) {
    return static_cast<int>(first + (letter(3) - ('I' - 'A')) * 10 + static_cast<std::size_t>(index));
  };
  if (name == "$C_TYP_PROG") return kTypes;
  if (name == "$C_ALL_PROG") return kAll;
  if (!name.starts_with("$C_") || name.size() < 4 || !is_capital(name[3])) return -1;
  const bool ijk = name[3] >= 'I' && name[3] <= 'K';
  const std::string_view rest = name.substr(4);
  if (rest == "_PROG") return static_cast<int>(own::argument_set + letter(3));
  if (ijk && rest == "_NUM") return static_cast<int>(own::argument_count + letter(3) - ('I' - 'A'));
  if (ijk && rest == "_ORDER" && index >= 0 && index < 10) return of_ijk(own::argument_order);
  if (!rest.empty()) return -1;
  if (name[3] == 'G') return own::argument_g;
  if (ijk) return index < 10 ? of_ijk(own::argument_ijk) - (index < 0 ? index : 0) : -1;
  return static_cast<int>(own::argument + letter(3));
}

int measured_number(std::string_view name, char axis) {
  if (name == "$AA_MW") return kWork + axis;
  return name == "$AA_MM" ? kMachine + axis : -1;
}

}  // namespace servogate::program::sinumerik::iso
