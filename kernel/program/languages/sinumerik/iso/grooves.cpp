// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/cycles/threading.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// Grooves G74 and G75, and threads in passes G76 (specification 18.8, 18.9). A block without an end stores.
namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kMostSteps = 10'000;

bool has_end(const BlockWords& words) { return words.axes > 0; }

/// What a program has stored, else the machine's in 0.001 mm.
double memory_mm(const Execution& run, std::size_t place, const char* name) {
  return memory(run, place, name, 0.001);
}

void begin(Execution& run, const BlockWords& words) {
  const int place = column(words);
  if (run.contour().engaged()) fail(Wrong::compensated, place, {g_word(run, words), "G41/G42"});
  run.motion().store_feed(words);
  run.motion().end_profile();
}

/// Pecks along one axis, each groove a step further across; `relief` at the bottom.
void groove(Execution& run, const BlockWords& words, char along_letter, char across_letter, char peck_letter,
            char step_letter) {
  begin(run, words);
  const std::string name = g_word(run, words);
  const int along = run.axes().find(along_letter), across = run.axes().find(across_letter);
  for (const char letter : {along_letter, across_letter})
    if (run.axes().find(letter) < 0) fail(Fault::axis_missing, column(words), {std::string(1, letter)});
  only(run, has_end(words) ? "XZUWPQRFSMT" : "R");
  State& state = run.state();
  if (!has_end(words)) {
    const Word* r = find(run.block(), 'R');
    if (r == nullptr) fail(Wrong::letter_missing, column(words), {name, "R"});
    return remember(run, own::groove_retract, std::abs(length(run, *r)));
  }
  if (words.axis[at(along)] == nullptr)
    fail(Wrong::target_missing, column(words), {name, std::string(1, along_letter)});
  const double begin_along = state.frames.programmed[at(along)], end = target(run, words, along);
  const double begin_across = state.frames.programmed[at(across)], last = target(run, words, across);
  const Word *peck_word = find(run.block(), peck_letter), *step_word = find(run.block(), step_letter);
  const double way = end - begin_along, forward = way < 0.0 ? -1.0 : 1.0;
  const double peck = peck_word == nullptr ? std::abs(way) : increments(run, *peck_word);
  const double side = last - begin_across;
  const double step = step_word == nullptr ? std::abs(side) : increments(run, *step_word);
  if (!(peck > 0.0)) fail(Wrong::step, column(words), {name, text::number(peck)});
  if (side != 0.0 && !(step > 0.0)) fail(Wrong::step, column(words), {name, text::number(step)});
  const double count = side == 0.0 ? 0.0 : std::ceil(std::abs(side) / step - 1e-6);
  if (count > kMostSteps || std::abs(way) / peck > kMostSteps)
    fail(Wrong::passes, column(words), {name, std::to_string(kMostSteps)});
  const double back = memory_mm(run, own::groove_retract, "ZSFI29");
  const Word* r = find(run.block(), 'R');
  const double relief = r == nullptr || side == 0.0 ? 0.0 : length(run, *r) * (side < 0.0 ? 1.0 : -1.0);
  for (int groove = 0; groove <= static_cast<int>(count); ++groove) {
    const double at_across =
        groove == static_cast<int>(count) ? last : begin_across + (side < 0.0 ? -1.0 : 1.0) * groove * step;
    run.motion().go(across, at_across, true);
    double bottom = begin_along;
    while (bottom != end) {
      bottom += forward * peck;
      if ((end - bottom) * forward < 1e-9) bottom = end;
      run.motion().go(along, bottom, false);
      if (bottom != end) run.motion().go(along, bottom - forward * back, true);
    }
    if (relief != 0.0 && groove > 0) run.motion().go(across, at_across + relief, true);
    run.motion().go(along, begin_along, true);
  }
  run.motion().go(across, begin_across, true);
}

}  // namespace

void remember(Execution& run, std::size_t place, double value_) {
  State& state = run.state();
  const auto bits = static_cast<unsigned>(value(state, own::memory_set));
  value(state, own::memory_set) = bits | 1u << (place - own::turning_depth);
  value(state, place) = value_;
}

double memory(const Execution& run, std::size_t place, const char* name, double unit) {
  const State& state = run.state();
  const auto bits = static_cast<unsigned>(value(state, own::memory_set));
  return (bits >> (place - own::turning_depth) & 1u) != 0 ? value(state, place) : setting(run, name) * unit;
}

void groove_along(Execution& run, const BlockWords& words) { groove(run, words, 'Z', 'X', 'Q', 'P'); }
void groove_across(Execution& run, const BlockWords& words) { groove(run, words, 'X', 'Z', 'P', 'Q'); }

/// P010060 is one finishing pass, no run-out, 60 degrees.
void thread_passes(Execution& run, const BlockWords& words) {
  const std::string name = g_word(run, words);
  const int place = column(words);
  State& state = run.state();
  if (!has_end(words)) {
    only(run, "PQR");
    if (const Word* p = find(run.block(), 'P'); p != nullptr) {
      const int packed = whole(run, 'P', 0);
      if (packed > 999'999)
        fail(Wrong::letter_range, p->column, {name, "P", std::to_string(packed), "mmrraa"});
      remember(run, own::thread_passes, std::max(1, packed / 10'000));
      remember(run, own::thread_chamfer, packed / 100 % 100);
      remember(run, own::thread_angle, packed % 100);
    }
    if (const Word* q = find(run.block(), 'Q'); q != nullptr)
      remember(run, own::thread_least, increments(run, *q));
    if (const Word* r = find(run.block(), 'R'); r != nullptr)
      remember(run, own::thread_allowance, std::abs(length(run, *r)));
    return;
  }
  only(run, "XZUWRPQFSMT");
  begin(run, words);
  for (const char letter : {'P', 'Q'})
    if (find(run.block(), letter) == nullptr)
      fail(Wrong::letter_missing, place, {name, std::string(1, letter)});
  for (const char letter : {'X', 'Z'})
    if (run.axes().find(letter) < 0 || words.axis[at(run.axes().find(letter))] == nullptr)
      fail(Wrong::target_missing, place, {name, std::string(1, letter)});
  if (run.machine().spindles == 0) fail(Fault::no_spindle, place, {name});
  Threading thread;
  thread.name = name;
  thread.along = run.axes().find('Z');
  thread.across = run.axes().find('X');
  thread.along_end = target(run, words, thread.along);
  thread.across_end = target(run, words, thread.across);
  const Word* r = find(run.block(), 'R');
  thread.taper = r == nullptr ? 0.0 : length(run, *r);
  thread.lead = state.motion.feed * (state.modes.unit == Function::inch ? 25.4 : 1.0);
  if (!(thread.lead > 0.0)) fail(Wrong::thread_lead, place, {name});
  thread.run_out = memory(run, own::thread_chamfer, "ZSFI26") * 0.1 * thread.lead;
  const double depth = increments(run, *find(run.block(), 'P'));
  const double first = increments(run, *find(run.block(), 'Q'));
  const double least = memory_mm(run, own::thread_least, "ZSFI27");
  const double allowance = std::min(depth, memory_mm(run, own::thread_allowance, "ZSFI28"));
  if (!(first > 0.0)) fail(Wrong::step, place, {name, text::number(first)});
  const double flank =
      std::tan(memory(run, own::thread_angle, "ZSFI25") / 2.0 * 3.14159265358979323846 / 180.0);
  const double in = thread.across_end < state.frames.programmed[at(thread.across)] ? -1.0 : 1.0;
  const auto cut = [&](double at_depth) {
    thread_pass(run, thread, thread.across_end - in * (depth - at_depth), at_depth * flank);
  };
  for (const double at_depth : thread_depths(name, depth - allowance, first, least)) cut(at_depth);
  const int finishing = static_cast<int>(memory(run, own::thread_passes, "ZSFI24"));
  for (int i = 0; i < finishing; ++i) cut(depth);
}

}  // namespace servogate::program::sinumerik::iso
