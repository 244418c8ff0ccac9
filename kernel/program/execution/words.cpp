// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

bool feed_motion(Function f) {
  return f == Function::line || f == Function::arc_cw || f == Function::arc_ccw;
}
bool arc_motion(Function f) { return f == Function::arc_cw || f == Function::arc_ccw; }

struct Plane {
  int number;
  char axis1, axis2, normal;
};
Plane plane_of(Function f) {
  if (f == Function::plane_12) return {17, 'X', 'Y', 'Z'};
  if (f == Function::plane_31) return {18, 'Z', 'X', 'Y'};
  return {19, 'Y', 'Z', 'X'};
}

}  // namespace

/// `required`: a program asks for it. At power-on a machine may lack an axis of it.
void Execution::select_plane(Function function, bool required) {
  const Plane plane = plane_of(function);
  const int axis1 = axes_.find(plane.axis1), axis2 = axes_.find(plane.axis2);
  if (required && (axis1 < 0 || axis2 < 0)) refuse_plane(function, static_cast<int>(block_.body) + 1);
  state_.modes.plane = function;
  set_plane(axis1, axis2, axes_.find(plane.normal));
}

void Execution::refuse_plane(Function function, int column) const {
  const Plane plane = plane_of(function);
  const char lacking = axes_.find(plane.axis1) < 0 ? plane.axis1 : plane.axis2;
  fail(Fault::plane_missing, column,
       {std::to_string(plane.number), std::string(1, plane.axis1), std::string(1, plane.axis2),
        std::string(1, lacking)});
}

void Execution::need_plane(int column) const {
  if (state_.modes.axis1 < 0 || state_.modes.axis2 < 0) refuse_plane(state_.modes.plane, column);
}

/// A block of words: modes first, then the functions before the motion, the motion, and what ends the block.
/// Source: specification A 5.
void Execution::run_words() {
  const Modes before = state_.modes;
  const BlockWords words = gather();
  if (words.cycle != 0 || state_.cycle.number != 0) return run_cycle_block(words);
  const bool arc_words = arc_motion(state_.modes.motion) &&
                         (words.centre1 != nullptr || words.centre2 != nullptr || words.radius != nullptr);
  const bool moves = words.axes > 0 || arc_words;
  if (!moves || state_.modes.motion == Function::rapid) end_profile();
  if (moves) check_profile(words);
  refuse_stray_words(words);
  store_feed(words);
  before_motion(words);
  if (moves) move(words);
  if (moves && words.one_shot != 0) return_modes(words.one_shot, before);
  after_motion(words);
}

/// The dialect's cycle takes the place of the motion; a feed profile ends here.
void Execution::run_cycle_block(const BlockWords& words) {
  end_profile();
  if (words.time != nullptr)
    fail(Fault::word_without_function, words.time->column, {word_text(block_, *words.time)});
  store_feed(words);
  before_motion(words);
  dialect_->cycle(*this, words);
  after_motion(words);
}

/// The former mode comes back in the groups where a block with motion changes it for itself only, and the
/// former S with its unit.
void Execution::return_modes(std::uint32_t one_shot, const Modes& before) {
  const auto acted = [&](std::initializer_list<Function> functions) {
    return std::any_of(functions.begin(), functions.end(),
                       [&](Function f) { return (one_shot >> static_cast<int>(f) & 1u) != 0; });
  };
  Modes& modes = state_.modes;
  if (acted({Function::absolute, Function::incremental})) modes.dimension = before.dimension;
  if (acted({Function::feed_inverse, Function::feed_minute, Function::feed_revolution}))
    modes.feed = before.feed;
  if (acted({Function::surface_speed, Function::revolutions}) && modes.spindle != before.spindle) {
    modes.spindle = before.spindle;
    if (modes.cutting != before.cutting) {
      modes.speed = before.speed;
      modes.cutting = before.cutting;
      state_.speed_told = false;
    }
  }
  if (acted({Function::inch, Function::metric})) modes.unit = before.unit;
  if (acted({Function::corner_limited, Function::continuous, Function::exact})) modes.corner = before.corner;
}

BlockWords Execution::gather() {
  BlockWords words;
  words.block = &block_;
  std::vector<const GRule*> rules;
  const bool by_parameter =
      std::any_of(block_.words.begin(), block_.words.begin() + block_.count,
                  [](const Word& w) { return w.meaning == Meaning::g && w.value.parameter >= 0; });
  for (std::size_t i = 0; i < block_.count; ++i) {
    const Word& word = block_.words[i];
    switch (word.meaning) {
      case Meaning::g: {
        const GRule* rule = word.g;
        if (by_parameter) {
          const int number = whole(word.value, "G");
          rule = dialect_->find_g(number);
          if (rule == nullptr) fail(Fault::g_unknown, word.column, {std::to_string(number)});
          rules.push_back(rule);
          check_parameter_g(rules, word);
        }
        take_g(words, *rule);
        if (rule->function == Function::cycle) words.cycle_word = &word;
        if (rule->function == Function::dwell) words.dwell_word = &word;
        break;
      }
      case Meaning::m: {
        const int code = whole(word.value, "M");
        if (code > 99) fail(Fault::out_of_range, word.value.column, {"M", std::to_string(code), "0", "99"});
        words.m[static_cast<std::size_t>(words.m_count)] = &word;
        words.m_code[static_cast<std::size_t>(words.m_count++)] = code;
        break;
      }
      case Meaning::axis:
        words.axis[static_cast<std::size_t>(word.axis)] = &word;
        ++words.axes;
        break;
      case Meaning::centre_1:
        words.centre1 = &word;
        break;
      case Meaning::centre_2:
        words.centre2 = &word;
        break;
      case Meaning::pitch:
        words.pitch = &word;
        break;
      case Meaning::radius:
        (words.radius == nullptr ? words.radius : words.radius2) = &word;
        break;
      case Meaning::feed:
        words.feed = &word;
        break;
      case Meaning::block_time:
        words.time = &word;
        break;
      case Meaning::speed:
        words.speed = &word;
        break;
      case Meaning::tool:
        words.tool = &word;
        break;
      case Meaning::h:
        words.h = &word;
        break;
      case Meaning::unknown:
      case Meaning::later:
      case Meaning::number:
        break;
    }
  }
  return words;
}

void Execution::check_parameter_g(const std::vector<const GRule*>& rules, const Word& last) const {
  const GRule& second = *rules.back();
  for (std::size_t i = 0; i + 1 < rules.size(); ++i)
    if (rules[i]->group == second.group || dialect_->conflict(rules[i]->number, second.number))
      fail(Fault::g_conflict, last.column, {std::to_string(rules[i]->number), std::to_string(second.number)});
  if (second.function == Function::later)
    fail(Fault::not_executed, last.column, {"G" + std::to_string(second.number)});
}

void Execution::take_g(BlockWords& words, const GRule& rule) {
  Modes& modes = state_.modes;
  if (rule.one_shot_with_motion) words.one_shot |= 1u << static_cast<int>(rule.function);
  switch (rule.function) {
    case Function::rapid:
    case Function::line:
    case Function::arc_cw:
    case Function::arc_ccw:
      modes.motion = rule.function;
      break;
    case Function::plane_12:
    case Function::plane_31:
    case Function::plane_23:
      select_plane(rule.function, words.block != nullptr);
      break;
    case Function::corner_limited:
    case Function::continuous:
    case Function::exact:
      modes.corner = rule.function;
      break;
    case Function::inch:
    case Function::metric:
      modes.unit = rule.function;
      break;
    case Function::absolute:
    case Function::incremental:
      modes.dimension = rule.function;
      break;
    case Function::machine_zero:
      words.machine_zero = true;
      break;
    case Function::dwell:
      words.dwell = true;
      break;
    case Function::exact_once:
      words.exact_once = true;
      break;
    case Function::feed_inverse:
    case Function::feed_minute:
    case Function::feed_revolution:
      modes.feed = rule.function;
      break;
    case Function::surface_speed:
    case Function::revolutions:
      modes.spindle = rule.function;
      break;
    case Function::cycle:
      words.cycle = rule.number;
      break;
    case Function::cycle_off:
      state_.cycle = Cycle{};
      break;
    case Function::nothing:
    case Function::later:
      break;
  }
}

/// M, S, T and H may not stand in a motion block of a continuous profile. Source: specification A 13.2,
/// A 6.5.
void Execution::check_profile(const BlockWords& words) const {
  if (!feed_motion(state_.modes.motion) || state_.modes.corner == Function::exact) return;
  const auto refuse = [&](const Word& word) {
    fail(Fault::function_in_profile, word.column, {word_text(block_, word)});
  };
  for (const Word* word : {words.speed, words.tool, words.h})
    if (word != nullptr) refuse(*word);
  for (int i = 0; i < words.m_count; ++i) {
    const MRule* rule = dialect_->find_m(words.m_code[static_cast<std::size_t>(i)]);
    const bool allowed = rule != nullptr && rule->in_profile && !state_.profile_open;
    if (!allowed) refuse(*words.m[static_cast<std::size_t>(i)]);
  }
}

/// Words that nothing in this block uses are told, not skipped.
void Execution::refuse_stray_words(const BlockWords& words) const {
  const bool arc = arc_motion(state_.modes.motion);
  const bool moves = words.axes > 0 || (arc && (words.centre1 || words.centre2 || words.radius));
  const auto refuse = [&](const Word* word) {
    if (word != nullptr) fail(Fault::word_without_function, word->column, {word_text(block_, *word)});
  };
  if (words.radius2 != nullptr) fail(Fault::word_twice, words.radius2->column, {"R"});
  if (!arc)
    for (const Word* word : {words.centre1, words.centre2, words.radius, words.pitch}) refuse(word);
  if (!moves || state_.modes.motion == Function::rapid) refuse(words.time);
  if (!moves) refuse(words.pitch);
}

}  // namespace servogate::program
