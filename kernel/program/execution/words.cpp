// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

bool arc_motion(Function f) { return f == Function::arc_cw || f == Function::arc_ccw; }

using Mode = Function Modes::*;

/// The mode that each function sets; null: it is none.
constexpr std::array<Mode, kFunctions> modes_of_functions() {
  std::array<Mode, kFunctions> of{};
  const auto set = [&](Function first, Function last, Mode mode) {
    for (auto f = static_cast<std::size_t>(first); f <= static_cast<std::size_t>(last); ++f) of[f] = mode;
  };
  set(Function::rapid, Function::arc_ccw, &Modes::motion);
  set(Function::corner_limited, Function::exact, &Modes::corner);
  set(Function::inch, Function::metric, &Modes::unit);
  set(Function::absolute, Function::incremental, &Modes::dimension);
  set(Function::diameter, Function::radius, &Modes::across);
  set(Function::feed_inverse, Function::feed_revolution, &Modes::feed);
  set(Function::surface_speed, Function::revolutions, &Modes::spindle);
  set(Function::compensation_off, Function::compensation_right, &Modes::compensation);
  set(Function::profile_off, Function::profile_on, &Modes::profile);
  set(Function::thread, Function::spline, &Modes::motion);
  return of;
}
constexpr std::array<Mode, kFunctions> kModes = modes_of_functions();

}  // namespace

/// A block of words: modes first, then the functions before the motion, the motion, and what ends the block.
/// Source: specification A 5.
void Execution::run_words() {
  const Modes before = state_.modes;
  const ProgrammedFeed feed_before = state_.motion;
  const BlockWords words = gather();
  const bool contour_ends = begin_contour(words, before);
  if (words.cycle != 0 || !state_.motion.cycle.name.empty()) return run_cycle_block(words);
  const bool arc_words = arc_motion(state_.modes.motion) &&
                         (words.centre1 != nullptr || words.centre2 != nullptr || words.radius != nullptr);
  const bool moves = words.instead == nullptr && (words.axes > 0 || arc_words);
  if (!moves || state_.modes.motion == Function::rapid) motion_.end_profile();
  if (moves && dialect_.profile != nullptr) dialect_.profile(*this, words);
  if (words.instead == nullptr) {
    refuse_stray_words(words);
    motion_.store_feed(words);
  }
  before_motion(words);
  if (words.mark_word != nullptr) wait_for_mark(words, moves || words.instead != nullptr);
  if (words.instead != nullptr) words.instead(*this, words);
  if (moves) {
    if (state_.modes.profile == Function::profile_on || state_.profile.open)
      dialect_.across(*this, words);
    else if (state_.modes.motion == Function::spline || state_.spline.phase != SplineState::Phase::none)
      dialect_.spline(*this, words);
    else if (state_.modes.motion == Function::thread)
      dialect_.thread(*this, words);
    else
      motion_.move(words);
  }
  if (contour_ends) contour_.end();
  if (words.one_shot != 0 && (words.axes > 0 || moves || words.counts_as_motion))
    return_modes(words, before, feed_before);
  if (words.plane_behind != Function::nothing) frames_.select_plane(words.plane_behind, false, 0);
  if (words.then != Function::nothing)
    state_.modes.*kModes[static_cast<std::size_t>(words.then)] = words.then;
  after_motion(words);
  for (int i = 0; i < words.statement_count; ++i) {
    const Word& word = *words.statements[static_cast<std::size_t>(i)];
    word.rule->run(*this, word);
  }
}

/// Compensation that the block chooses begins with its motion. True: it ends behind it.
bool Execution::begin_contour(const BlockWords& words, const Modes& before) {
  const Function was = before.compensation, is = state_.modes.compensation;
  if (was == is) {
    if (contour_.engaged()) refuse_in_contour(words);
    return false;
  }
  if (is == Function::compensation_off) {
    if (!dialect_.side_changes) return true;
    contour_.end();
    return false;
  }
  const int column = static_cast<int>(block_.body) + 1;
  if (was != Function::compensation_off && dialect_.side_changes)
    contour_.end();
  else if (was != Function::compensation_off || contour_.engaged())
    fail(Fault::contour_side, column, {name_of(is), name_of(was)});
  if (words.cycle != 0 || !state_.motion.cycle.name.empty())
    fail(Fault::contour_excludes, column, {state_.motion.cycle.name});
  if (frames_.tool_radius() + state_.motion.allowance == 0.0) {
    Written place = capability_.written(column);
    capability_.warn(place, Fault::no_radius, {name_of(is)});
  }
  contour_.begin(is == Function::compensation_left ? 1 : -1, frames_.tool_radius() + state_.motion.allowance,
                 column);
  return false;
}

/// The motion of the block waits for the zero mark of the spindle (specification A 12.4).
void Execution::wait_for_mark(const BlockWords& words, bool moves) {
  const std::string word = word_text(dialect_, block_, *words.mark_word);
  if (!moves || state_.modes.motion == Function::rapid)
    fail(Fault::mark_motion, words.mark_word->column, {word});
  if (state_.motion.spindle == SpindleMode::stop) fail(Fault::mark_spindle, words.mark_word->column, {word});
  emit(SpindleMark{});
}

/// Inside of a compensated contour stand motions only, and those in its plane.
void Execution::refuse_in_contour(const BlockWords& words) const {
  const auto refuse = [&](const Word* word) {
    if (word != nullptr) fail(Fault::contour_excludes, word->column, {word_text(dialect_, block_, *word)});
  };
  if (words.machine_zero)
    fail(Fault::contour_excludes, static_cast<int>(block_.body) + 1, {name_of(Function::machine_zero)});
  for (const Word* word : {words.speed, words.tool, words.corrector, words.h, words.cycle_word}) refuse(word);
  for (const Word* word : words.factor) refuse(word);
  if (!contour_.compensates() || dialect_.side_changes) return;
  for (int i = 0; i < words.m_count; ++i) refuse(words.m[static_cast<std::size_t>(i)]);
}

/// "G41": the word of a function.
std::string Execution::name_of(Function function) const {
  for (const GRule& rule : dialect_.g)
    if (rule.function == function) return "G" + g_name(rule.number);
  return {};
}

/// The dialect's cycle takes the place of the motion; a feed profile ends here.
void Execution::run_cycle_block(const BlockWords& words) {
  motion_.end_profile();
  if (words.time != nullptr)
    fail(Fault::word_without_function, words.time->column, {word_text(dialect_, block_, *words.time)});
  for (const Word* word : {words.count, words.angle, words.amount, words.instead_word, words.factor[0],
                           words.factor[1], words.factor[2]})
    if (word != nullptr)
      fail(Fault::word_without_function, word->column, {word_text(dialect_, block_, *word)});
  motion_.store_feed(words);
  before_motion(words);
  dialect_.cycle(*this, words);
  after_motion(words);
}

/// The former mode comes back in the groups where a block with motion changes it for itself only, and the
/// former S and F with their units.
void Execution::return_modes(const BlockWords& words, const Modes& before, const ProgrammedFeed& feed) {
  Modes& modes = state_.modes;
  for (std::size_t f = 0; f < kFunctions; ++f) {
    if ((words.one_shot >> f & 1u) == 0 || kModes[f] == nullptr) continue;
    if (kModes[f] == &Modes::spindle && modes.spindle != before.spindle && modes.cutting != before.cutting) {
      modes.speed = before.speed;
      modes.cutting = before.cutting;
      state_.motion.speed_told = false;
    }
    if (kModes[f] == &Modes::feed && modes.feed != before.feed)
      static_cast<ProgrammedFeed&>(state_.motion) = feed;
    modes.*kModes[f] = before.*kModes[f];
  }
}

void Execution::take_g(BlockWords& words, const GRule& rule) {
  if (rule.one_shot_with_motion) words.one_shot |= std::uint64_t{1} << static_cast<int>(rule.function);
  if (rule.then != Function::nothing) words.then = rule.then;
  if (const Mode mode = kModes[static_cast<std::size_t>(rule.function)]; mode != nullptr) {
    state_.modes.*mode = rule.function;
    return;
  }
  switch (rule.function) {
    case Function::plane_12:
    case Function::plane_31:
    case Function::plane_23:
      if (words.block != nullptr && (contour_.engaged() || state_.contour.shifted()))
        fail(Fault::contour_excludes, static_cast<int>(block_.body) + 1, {"G" + g_name(rule.number)});
      return frames_.select_plane(rule.function, words.block != nullptr, static_cast<int>(block_.body) + 1);
    case Function::work_offset:
      return frames_.use_origin(rule.value, static_cast<int>(block_.body) + 1);
    case Function::machine_zero:
      words.machine_zero = true;
      return;
    case Function::dwell:
      words.dwell = true;
      return;
    case Function::exact_once:
      words.exact_once = true;
      return;
    case Function::cycle:
      words.cycle = rule.number;
      return;
    case Function::cycle_off:
      state_.motion.cycle = Cycle{};
      return;
    default:
      return;
  }
}

void Execution::refuse_words_but_axes(const BlockWords& words) const {
  for (const Word* word :
       {words.centre1, words.centre2, words.pitch, words.radius, words.radius2, words.time, words.count,
        words.angle, words.amount, words.factor[0], words.factor[1], words.factor[2]})
    if (word != nullptr)
      fail(Fault::word_without_function, word->column, {word_text(dialect_, block_, *word)});
}

void Execution::refuse_all_but(const BlockWords& words, std::initializer_list<const Word*> taken) const {
  const auto refuse = [&](const Word* word) {
    if (word == nullptr || std::find(taken.begin(), taken.end(), word) != taken.end()) return;
    fail(Fault::word_without_function, word->column, {word_text(dialect_, block_, *word)});
  };
  for (const Word* word : words.axis) refuse(word);
  for (const Word* word : {words.centre1, words.centre2, words.pitch, words.radius, words.radius2, words.feed,
                           words.time, words.count, words.angle, words.amount})
    refuse(word);
}

/// Words that nothing in this block uses are told, not skipped.
void Execution::refuse_stray_words(const BlockWords& words) const {
  const bool arc = arc_motion(state_.modes.motion);
  const bool moves = words.axes > 0 || (arc && (words.centre1 || words.centre2 || words.radius));
  const auto refuse = [&](const Word* word) {
    if (word != nullptr)
      fail(Fault::word_without_function, word->column, {word_text(dialect_, block_, *word)});
  };
  if (words.radius2 != nullptr)
    fail(Fault::word_twice, words.radius2->column, {std::string(1, words.radius2->letter)});
  const bool thread = state_.modes.motion == Function::thread && words.axes > 0;
  if (!arc && !thread)
    for (const Word* word : {words.centre1, words.centre2, words.radius, words.pitch}) refuse(word);
  if (!moves || state_.modes.motion == Function::rapid) refuse(words.time);
  if (!moves) refuse(words.pitch);
  if (words.has_factors && !moves)
    for (const Word* word : words.factor) refuse(word);
  if (words.for_instead)
    for (const Word* word : {words.count, words.angle, words.amount}) refuse(word);
}

}  // namespace servogate::program
