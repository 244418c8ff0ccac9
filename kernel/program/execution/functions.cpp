// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

constexpr double kMetresPerFoot = 0.3048;

SpindleMode mode_of(MAction action) {
  switch (action) {
    case MAction::spindle_cw:
      return SpindleMode::cw;
    case MAction::spindle_ccw:
      return SpindleMode::ccw;
    case MAction::spindle_orient:
      return SpindleMode::orient;
    case MAction::spindle_stop:
      return SpindleMode::stop;
    default:
      return SpindleMode::keep;
  }
}

/// A reversal depends on how the spindle turns; keep: it is none of the spindle's, or it stands.
SpindleMode ordered(MAction action, SpindleMode now) {
  if (action != MAction::spindle_reverse) return mode_of(action);
  return now == SpindleMode::cw    ? SpindleMode::ccw
         : now == SpindleMode::ccw ? SpindleMode::cw
                                   : SpindleMode::keep;
}

}  // namespace

/// T, then the spindle, then the M functions of the class "start of motion" in the order written, then H.
void Execution::before_motion(const BlockWords& words) {
  if (!words.tool_behind && (words.tool != nullptr || words.corrector != nullptr)) tool_words(words);
  const MRule* start = nullptr;
  const Word* start_word = nullptr;
  for (int i = 0; i < words.m_count; ++i) {
    const MRule* rule = dialect_.find_m(words.m_code[static_cast<std::size_t>(i)]);
    if (rule == nullptr || rule->after_motion ||
        ordered(rule->action, state_.motion.spindle) == SpindleMode::keep)
      continue;
    if (start != nullptr)
      fail(Fault::spindle_conflict, words.m[static_cast<std::size_t>(i)]->column,
           {std::to_string(start->code), std::to_string(rule->code)});
    start = rule;
    start_word = words.m[static_cast<std::size_t>(i)];
    if (machine_.spindles == 0)
      fail(Fault::no_spindle, words.m[static_cast<std::size_t>(i)]->column,
           {"M" + std::to_string(rule->code)});
  }
  spindle_word(words, start, start_word);
  for (int i = 0; i < words.m_count; ++i) {
    const int code = words.m_code[static_cast<std::size_t>(i)];
    const MRule* rule = dialect_.find_m(code);
    if (rule != nullptr && rule->after_motion) continue;
    emit(MFunction{code, false});
    change_spindle(code, words.m[static_cast<std::size_t>(i)]->column);
  }
  if (words.h != nullptr) emit(HFunction{numbers_.whole(words.h->value, "H")});
}

/// The M functions of the machine file that make the spindle an axis, and a spindle again.
void Execution::change_spindle(int code, int column) {
  const int axis = machine_.spindle_axis;
  MotionState& motion = state_.motion;
  const bool on = code == machine_.spindle_axis_on_m;
  if (axis < 0 || (!on && code != machine_.spindle_axis_off_m) || on == motion.spindle_is_axis) return;
  if (motion.coupled)
    fail(Fault::spindle_axis_coupled, column, {machine_.axes[static_cast<std::size_t>(axis)].letter});
  motion_.end_profile();
  emit(SpindleAxis{on});
  set_spindle_axis(on);
  motion.spindle = SpindleMode::stop;
}

/// The axis that it may become stands where the program knows it to stand.
void Execution::set_spindle_axis(bool on) {
  if (machine_.spindle_axis < 0) return;
  state_.motion.spindle_is_axis = on;
  state_.motion.spindle_axis_place = state_.frames.machine[static_cast<std::size_t>(machine_.spindle_axis)];
}

/// T and the corrector: as one word, or each with its own.
void Execution::tool_words(const BlockWords& words) {
  const Word& word = words.tool != nullptr ? *words.tool : *words.corrector;
  if (words.tool != nullptr) {
    state_.frames.tool = numbers_.whole(words.tool->value, "T");
    state_.frames.corrector = numbers_.whole(block_.corrector, "T");
  }
  const auto row = dialect_.corrector;
  int chosen = 1;
  if (row != nullptr) {
    chosen = words.corrector != nullptr ? numbers_.whole(words.corrector->value, "D") : 1;
    state_.frames.corrector = chosen == 0 || state_.frames.tool == 0 ? 0 : row(state_.frames.tool, chosen);
  }
  if (words.tool != nullptr) replace_worn_out(word, chosen);
  const int most = static_cast<int>(dialect_.letters[static_cast<unsigned char>(word.letter)].max);
  if (state_.frames.tool > most || (row == nullptr && state_.frames.corrector > most))
    fail(Fault::out_of_range, word.column,
         {"T", std::to_string(std::max(state_.frames.tool, state_.frames.corrector)), "0",
          std::to_string(most)});
  capability_.check_tool(word.column);
  if (words.tool != nullptr)
    emit(Tool{state_.frames.tool, state_.frames.corrector, dialect_.tool_change == ToolChange::at_once});
  if (dialect_.tool_change == ToolChange::at_once || words.tool == nullptr) change_tool();
}

/// A tool whose life is over gives way to its alternate, and that one to its own.
void Execution::replace_worn_out(const Word& word, int chosen) {
  constexpr int kMostAlternates = 32;  // they may name one another in a circle
  auto &tool = state_.frames.tool, &corrector = state_.frames.corrector;
  const auto& rows = state_.frames.tables->correctors;
  const int programmed = tool;
  for (int n = 0; tool != 0; ++n) {
    const auto row = rows.find(corrector != 0 ? corrector : tool);
    if (row == rows.end() || !row->second.worn_out()) return;
    if (row->second.alternate == 0 || n == kMostAlternates)
      fail(Fault::tool_worn_out, word.column,
           {std::to_string(programmed), text::number(row->second.life_min, 1)});
    tool = row->second.alternate;
    if (corrector != 0) corrector = dialect_.corrector != nullptr ? dialect_.corrector(tool, chosen) : tool;
  }
}

void Execution::spindle_word(const BlockWords& words, const MRule* start, const Word* start_word) {
  if (words.speed != nullptr) output_.refuse_turning(words.speed->column);
  if (start != nullptr && start->action != MAction::spindle_stop) output_.refuse_turning(start_word->column);
  if (words.speed != nullptr) {
    if (machine_.spindles == 0)
      fail(Fault::no_spindle, words.speed->column, {word_text(dialect_, block_, *words.speed)});
    const double speed = numbers_.resolve(words.speed->value);
    const LetterRule& rule = dialect_.letters[static_cast<unsigned char>(words.speed->letter)];
    if (!(speed >= rule.min && speed <= rule.max))
      numbers_.refuse_range("S", words.speed->value, speed, text::number(rule.min).c_str(),
                            text::number(rule.max).c_str());
    state_.modes.cutting = state_.modes.spindle == Function::surface_speed;
    const bool feet = state_.modes.unit == Function::inch && state_.modes.cutting;
    state_.modes.speed = feet ? speed * kMetresPerFoot : speed;
    state_.motion.speed_at = capability_.written(words.speed->column);
  } else if (state_.modes.cutting && state_.modes.spindle != Function::surface_speed) {
    state_.modes.speed = capability_.spindle_rpm(state_.frames.machine);  // G97 keeps the speed of the moment
    state_.modes.cutting = state_.motion.speed_told = false;
  }
  const bool turns = start != nullptr && start->action != MAction::spindle_orient;
  if (turns) capability_.check_start(*start_word);
  if (words.speed != nullptr || turns)
    capability_.check_speed(words.speed != nullptr ? *words.speed : *start_word);
  if (start != nullptr) {
    const SpindleMode mode = ordered(start->action, state_.motion.spindle);
    if (start->action == MAction::spindle_reverse) motion_.turn_spindle(SpindleMode::stop);
    motion_.turn_spindle(mode);
  } else if (state_.motion.spindle == SpindleMode::turn) {
    state_.motion.speed_told = false;  // it stands where it has been turned to
  } else if (words.speed != nullptr ||
             (!state_.motion.speed_told && state_.motion.spindle != SpindleMode::stop))
    motion_.turn_spindle(state_.motion.spindle);
}

/// Dwell, then the M functions of the class "end of motion" in the order written; what stops or ends the
/// program last.
void Execution::after_motion(const BlockWords& words) {
  if (words.tool_behind) tool_words(words);
  if (words.dwell) dialect_.dwell(*this, *words.dwell_word);
  int last = -1;
  for (int i = 0; i < words.m_count; ++i) {
    const int code = words.m_code[static_cast<std::size_t>(i)];
    const MRule* rule = dialect_.find_m(code);
    if (rule == nullptr || !rule->after_motion) continue;
    const bool ends = (rule->action >= MAction::stop && rule->action <= MAction::end_rewind) ||
                      rule->action == MAction::subprogram_end || rule->action == MAction::repeat_end;
    if (ends && last >= 0)
      fail(Fault::m_end_twice, words.m[static_cast<std::size_t>(i)]->column,
           {std::to_string(words.m_code[static_cast<std::size_t>(last)]), std::to_string(code)});
    if (ends)
      last = i;
    else
      end_function(code, rule, words.m[static_cast<std::size_t>(i)]->column);
  }
  if (last < 0) return;
  const int code = words.m_code[static_cast<std::size_t>(last)];
  end_function(code, dialect_.find_m(code), words.m[static_cast<std::size_t>(last)]->column);
}

void Execution::end_function(int code, const MRule* rule, int column) {
  const bool program_end = rule->action == MAction::end || rule->action == MAction::end_rewind;
  if (rule->action == MAction::repeat_end) return flow_.end_repeat(column);
  const bool returns = rule->action == MAction::subprogram_end || (program_end && dialect_.end_returns);
  if (returns && flow_.leave_subprogram()) return;
  if (rule->action == MAction::subprogram_end && !dialect_.subprogram_end_ends) return;
  if (program_end && !state_.flow.calls.empty())
    fail(Fault::end_in_subprogram, column,
         {std::to_string(code), flow_.names()[static_cast<std::size_t>(flow_.file())]});
  if (rule->action == MAction::spindle_orient && machine_.spindles == 0)
    fail(Fault::no_spindle, column, {"M" + std::to_string(code)});
  if (rule->action == MAction::spindle_stop || rule->action == MAction::spindle_orient)
    motion_.turn_spindle(mode_of(rule->action));
  emit(MFunction{code, true});
  if (rule->action == MAction::none) change_spindle(code, column);
  switch (rule->action) {
    case MAction::stop:
      emit(Stop{false});
      break;
    case MAction::optional_stop:
      if (state_.optional_stop != 0) emit(Stop{state_.optional_stop < 0});
      break;
    case MAction::tool_change:
      change_tool();
      break;
    case MAction::end:
    case MAction::subprogram_end:
      finish(false);
      break;
    case MAction::end_rewind:
      finish(true);
      break;
    default:
      break;
  }
}

/// The lengths of the corrector come into force; nothing moves by itself. A cutting speed goes by the new
/// tool's radius.
void Execution::change_tool() {
  const double center =
      capability_.surface_axis() < 0 ? 0.0 : state_.frames.frame.length(capability_.surface_axis());
  frames_.use_lengths(state_.frames.corrector);
  const bool by_radius = state_.modes.cutting && state_.modes.speed > 0.0;
  if (by_radius && capability_.surface_axis() >= 0 &&
      state_.frames.frame.length(capability_.surface_axis()) != center)
    motion_.turn_spindle(state_.motion.spindle);
}

}  // namespace servogate::program
