// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/cycles/boring.hpp"
#include "kernel/program/cycles/tapping.hpp"
#include "kernel/program/languages/sinumerik/iso/holes.hpp"

/// The drilling cycles: their words, which last over blocks, and where they drill (specification 19, 20).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kMostRepeats = 9999;

/// What a word of the cycle counts from: zero, or the level before it.
double level_of(const Execution& run, int axis, const Word& word, double from, bool incremental) {
  const double value = run.numbers().length(axis, word.value);
  return incremental ? from + value : value;
}

void take_words(Execution& run, const BlockWords& words, Hole& hole) {
  State& state = run.state();
  const Block& block = run.block();
  const bool turns = run.machine().turns();
  const bool adds = state.modes.dimension == Function::incremental;
  if (const Word* r = find(block, 'R'); r != nullptr) {
    const double level = length(run, *r);
    value(state, own::hole_level) = turns || adds ? hole.initial + level : level;
  }
  hole.level = value(state, own::hole_level);
  if (const Word* depth = words.axis[at(hole.axis)]; depth != nullptr) {
    const bool from_level = depth->value.dimension == Dimension::incremental || adds;
    value(state, own::hole_incremental) = from_level ? 1.0 : 0.0;
    value(state, own::hole_depth) = level_of(run, hole.axis, *depth, 0.0, false);
  }
  hole.depth =
      value(state, own::hole_depth) + (value(state, own::hole_incremental) != 0.0 ? hole.level : 0.0);
  if (const Word* q = find(block, 'Q'); q != nullptr)
    value(state, own::hole_step) = turns ? increments(run, *q) : notated(run, *q);
  if (find(block, 'P') != nullptr) value(state, own::hole_dwell) = std::abs(number(run, 'P')) / 1000.0;
  hole.step = value(state, own::hole_step);
  hole.dwell_s = value(state, own::hole_dwell);
  hole.repeats = whole(run, 'K', 1);
  if (hole.repeats > kMostRepeats)
    fail(Fault::out_of_range, find(block, 'K')->column,
         {"K", std::to_string(hole.repeats), "0", std::to_string(kMostRepeats)});
}

/// M of a block is the clamp of the C axis of turning: so before the hole, and the next number behind it.
int clamp_of(const Execution& run, const BlockWords& words) {
  for (std::size_t i = 0; i < run.block().count; ++i) {
    const Word& word = run.block().words[i];
    if (word.meaning == Meaning::m &&
        std::find(words.m.begin(), words.m.begin() + words.m_count, &word) == words.m.begin() + words.m_count)
      return run.numbers().whole(word.value, "M");
  }
  return -1;
}

/// At rapid to the words of the block; polar ones count anew at each repeat.
void to_place(Execution& run, const BlockWords& words, int axis) {
  if (value(run.state(), own::polar) == 0.0) return run.motion().position(words, axis);
  const Block written = run.block();
  BlockWords place = words;
  arrange_polar(run, place);
  run.motion().position(place, axis);
  run.block() = written;
}

/// Behind R the tool does not turn back towards the initial plane; G87 of milling bores upwards.
void judge_depth(const Execution& run, const Hole& hole) {
  if (hole.g == 87 && !run.machine().turns()) return;
  const double in = hole.depth - hole.level, back = hole.initial - hole.level;
  if (std::abs(in) > 1e-9 && (in * back <= 0.0 || std::abs(in) > std::abs(back) + 1e-9)) return;
  const MachineModel::Axis& axis = run.machine().axes[at(hole.axis)];
  const double shown = axis.diameter ? 2.0 : 1.0;
  fail(Wrong::hole_depth, hole.column,
       {hole.name, axis.letter, text::number(shown * hole.level), text::number(shown * hole.depth)});
}

void drill(Execution& run, const BlockWords& words) {
  State& state = run.state();
  const bool turns = run.machine().turns();
  only(run, turns ? "XYZUVWCHRQPFKMSTB" : "XYZABCUVWRQPFKMSTHD");
  Hole hole;
  hole.g = static_cast<int>(value(state, own::hole));
  hole.name = "G" + std::to_string(hole.g);
  hole.column = static_cast<int>(run.block().body) + 1;
  if (run.contour().engaged()) fail(Wrong::compensated, hole.column, {hole.name, "G41/G42"});
  run.frames().need_plane(hole.column);
  hole.axis = turns                          ? run.axes().find(hole.g >= 87 ? 'X' : 'Z')
              : setting(run, "ZSFI0") == 1.0 ? run.axes().find('Z')
                                             : state.frames.normal;
  if (hole.axis < 0) fail(Wrong::axis_alone, hole.column, {hole.name});
  if (value(state, own::hole_begun) == 0.0) {
    value(state, own::hole_begun) = 1.0;
    value(state, own::hole_initial) = state.frames.programmed[at(hole.axis)];
    value(state, own::hole_level) = value(state, own::hole_initial);
    value(state, own::hole_depth) = value(state, own::hole_initial);
  }
  hole.initial = value(state, own::hole_initial);
  run.motion().store_feed(words);
  take_words(run, words, hole);
  judge_depth(run, hole);
  run.motion().end_profile();
  const int clamp = turns ? clamp_of(run, words) : -1;
  const bool places = words.axes > (words.axis[at(hole.axis)] != nullptr ? 1 : 0);
  for (int i = 0; i < hole.repeats; ++i) {
    if (places) to_place(run, words, hole.axis);
    if (clamp >= 0) run.emit(MFunction{clamp, false});
    turns ? turned_hole(run, hole) : milled_hole(run, hole);
    run.motion().go(hole.axis, value(state, own::to_r) != 0.0 ? hole.level : hole.initial, true);
    if (clamp >= 0) run.emit(MFunction{clamp + 1, false});
  }
}

}  // namespace

double reentry(const Execution& run, double depth) {
  const double set = setting(run, "ZSFR10");
  if (set > 0.0) return set;
  const double total = std::abs(depth);
  return total <= 30.0 ? 0.6 : std::min(total / 50.0, 7.0);
}

double tapping_lead(const Execution& run, const Hole& hole) {
  const State& state = run.state();
  if (state.modes.cutting || state.modes.speed <= 0.0) fail(Wrong::dwell_spindle, hole.column, {hole.name});
  if (state.motion.feed <= 0.0) fail(Fault::feed_missing, hole.column);
  if (state.modes.feed == Function::feed_revolution) return state.motion.feed;
  if (bit(run, 8)) return state.motion.feed;
  return state.motion.feed / state.modes.speed;
}

void begin_hole(Execution& run, BlockWords&, const Word& word) {
  State& state = run.state();
  if (value(state, own::hole) == 0.0) value(state, own::hole_begun) = 0.0;
  value(state, own::hole) = word.g != nullptr ? word.g->number : word.value.number;
  value(state, own::turning_cycle) = 0.0;
}

void end_hole(Execution& run, BlockWords&, const Word&) {
  value(run.state(), own::hole) = value(run.state(), own::turning_cycle) = 0.0;
  value(run.state(), own::hole_step) = value(run.state(), own::hole_dwell) = 0.0;
}

/// It drills in blocks with a place or a level (specification 20.1).
void arrange_hole(Execution& run, BlockWords& words) {
  if (value(run.state(), own::hole) == 0.0 || words.instead != nullptr) return;
  if (words.axes == 0 && words.radius == nullptr) return;
  words.instead = drill;
  words.instead_word = &run.block().words[0];
  if (!run.machine().turns()) return;
  int kept = 0;
  for (int i = 0; i < words.m_count; ++i) {
    if (run.dialect().find_m(words.m_code[at(i)]) == nullptr) continue;  // the clamp of the C axis
    words.m[at(kept)] = words.m[at(i)];
    words.m_code[at(kept++)] = words.m_code[at(i)];
  }
  words.m_count = kept;
}

/// Face and side are the same but for the axis (specification 19).
void turned_hole(Execution& run, const Hole& hole) {
  const int kind = hole.g >= 87 ? hole.g - 4 : hole.g;
  if (kind == 84) {
    Tapping thread;
    thread.name = hole.name;
    thread.axis = hole.axis;
    thread.approach = hole.level;
    thread.depth = hole.depth;
    thread.lead = tapping_lead(run, hole);
    thread.dwell_s = hole.dwell_s;
    return tap_hole(run, thread);
  }
  Boring work;
  work.name = hole.name;
  work.axis = hole.axis;
  work.approach = work.retreat = hole.level;
  work.depth = hole.depth;
  work.dwell_bottom_s = hole.dwell_s;
  if (kind == 85) {
    if (run.state().motion.feed <= 0.0) fail(Fault::feed_missing, hole.column);
    work.back_feed = run.state().motion.feed;
  } else if (hole.step > 0.0 && setting(run, "ZSFI20") == 1.0) {
    work.first = work.next = hole.step;
    work.reentry = reentry(run, hole.depth - hole.level);
    work.dwell_out_s = setting(run, "ZSFR22");
  } else if (hole.step > 0.0) {
    work.chips = {.on = true, .pass = hole.step, .back = setting(run, "ZSFR21")};
  }
  bore(run, work);
}

}  // namespace servogate::program::sinumerik::iso
