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

}  // namespace

/// T, then the spindle, then the M functions of the class "start of motion" in the order written, then H.
void Execution::before_motion(const BlockWords& words) {
  if (words.tool != nullptr || words.corrector != nullptr) tool_words(words);
  const MRule* start = nullptr;
  const Word* start_word = nullptr;
  for (int i = 0; i < words.m_count; ++i) {
    const MRule* rule = dialect_->find_m(words.m_code[static_cast<std::size_t>(i)]);
    if (rule == nullptr || rule->after_motion || mode_of(rule->action) == SpindleMode::keep) continue;
    if (start != nullptr)
      fail(Fault::spindle_conflict, words.m[static_cast<std::size_t>(i)]->column,
           {std::to_string(start->code), std::to_string(rule->code)});
    start = rule;
    start_word = words.m[static_cast<std::size_t>(i)];
    if (machine_->spindles == 0)
      fail(Fault::no_spindle, words.m[static_cast<std::size_t>(i)]->column,
           {"M" + std::to_string(rule->code)});
  }
  spindle_word(words, start, start_word);
  for (int i = 0; i < words.m_count; ++i) {
    const int code = words.m_code[static_cast<std::size_t>(i)];
    const MRule* rule = dialect_->find_m(code);
    if (rule == nullptr || !rule->after_motion) emit(MFunction{code, false});
  }
  if (words.h != nullptr) emit(HFunction{whole(words.h->value, "H")});
}

/// T and the corrector: as one word, or each with its own.
void Execution::tool_words(const BlockWords& words) {
  const Word& word = words.tool != nullptr ? *words.tool : *words.corrector;
  if (words.tool != nullptr) {
    state_.tool = whole(words.tool->value, "T");
    state_.corrector = whole(block_.corrector, "T");
  }
  const auto row = dialect_->corrector;
  if (row != nullptr) {
    const int chosen = words.corrector != nullptr ? whole(words.corrector->value, "D") : 1;
    state_.corrector = chosen == 0 || state_.tool == 0 ? 0 : row(state_.tool, chosen);
  }
  const int most = static_cast<int>(dialect_->letters[static_cast<unsigned char>(word.letter)].max);
  if (state_.tool > most || (row == nullptr && state_.corrector > most))
    fail(Fault::out_of_range, word.column,
         {"T", std::to_string(std::max(state_.tool, state_.corrector)), "0", std::to_string(most)});
  check_tool(word.column);
  if (words.tool != nullptr)
    emit(Tool{state_.tool, state_.corrector, dialect_->tool_change == ToolChange::at_once});
  if (dialect_->tool_change == ToolChange::at_once || words.tool == nullptr) change_tool();
}

void Execution::spindle_word(const BlockWords& words, const MRule* start, const Word* start_word) {
  if (words.speed != nullptr) {
    if (machine_->spindles == 0)
      fail(Fault::no_spindle, words.speed->column, {word_text(*dialect_, block_, *words.speed)});
    const double speed = resolve(words.speed->value);
    const LetterRule& rule = dialect_->letters[static_cast<unsigned char>(words.speed->letter)];
    if (!(speed >= rule.min && speed <= rule.max))
      refuse_range("S", words.speed->value, speed, text::number(rule.min).c_str(),
                   text::number(rule.max).c_str());
    state_.modes.cutting = state_.modes.spindle == Function::surface_speed;
    const bool feet = state_.modes.unit == Function::inch && state_.modes.cutting;
    state_.modes.speed = feet ? speed * kMetresPerFoot : speed;
    state_.speed_at = written(words.speed->column);
  } else if (state_.modes.cutting && state_.modes.spindle != Function::surface_speed) {
    state_.modes.speed = spindle_rpm(state_.machine);  // G97 keeps the speed of the moment
    state_.modes.cutting = state_.speed_told = false;
  }
  const bool turns = start != nullptr && start->action != MAction::spindle_orient;
  if (turns) check_start(*start_word);
  if (words.speed != nullptr || turns) check_speed(words.speed != nullptr ? *words.speed : *start_word);
  if (start != nullptr)
    emit_spindle(mode_of(start->action));
  else if (words.speed != nullptr || (!state_.speed_told && state_.spindle != SpindleMode::stop))
    emit_spindle(state_.spindle);
}

void Execution::emit_spindle(SpindleMode mode) {
  state_.spindle = mode;
  Spindle spindle;
  spindle.mode = mode;
  spindle.speed = state_.modes.speed;
  spindle.surface_speed = state_.modes.cutting;
  if (spindle.surface_speed && surface_axis_ >= 0) spindle.center = state_.frame.length(surface_axis_);
  emit(spindle);
  state_.speed_told = true;
}

/// Dwell, then the M functions of the class "end of motion" in the order written; what stops or ends the
/// program last.
void Execution::after_motion(const BlockWords& words) {
  if (words.dwell) dialect_->dwell(*this, *words.dwell_word);
  int last = -1;
  for (int i = 0; i < words.m_count; ++i) {
    const int code = words.m_code[static_cast<std::size_t>(i)];
    const MRule* rule = dialect_->find_m(code);
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
  end_function(code, dialect_->find_m(code), words.m[static_cast<std::size_t>(last)]->column);
}

void Execution::end_function(int code, const MRule* rule, int column) {
  const bool program_end = rule->action == MAction::end || rule->action == MAction::end_rewind;
  if (rule->action == MAction::repeat_end) return end_repeat(column);
  const bool returns = rule->action == MAction::subprogram_end || (program_end && dialect_->end_returns);
  if (returns && leave_subprogram()) return;
  if (rule->action == MAction::subprogram_end && !dialect_->subprogram_end_ends) return;
  if (program_end && !state_.flow.calls.empty())
    fail(Fault::end_in_subprogram, column,
         {std::to_string(code), files_[static_cast<std::size_t>(state_.flow.file)]});
  if (rule->action == MAction::spindle_stop) emit_spindle(SpindleMode::stop);
  emit(MFunction{code, true});
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
  const double center = surface_axis_ < 0 ? 0.0 : state_.frame.length(surface_axis_);
  use_lengths(state_.corrector);
  const bool by_radius = state_.modes.cutting && state_.modes.speed > 0.0;
  if (by_radius && surface_axis_ >= 0 && state_.frame.length(surface_axis_) != center)
    emit_spindle(state_.spindle);
}

void Execution::use_lengths(int row) {
  const auto& correctors = state_.tables->correctors;
  const auto entry = correctors.find(row);
  for (int a = 0; a < axis_count(); ++a) {
    double length = 0.0;
    if (row != 0 && entry != correctors.end()) {
      const auto at = entry->second.length.find(machine_->axes[static_cast<std::size_t>(a)].letter);
      if (at != entry->second.length.end()) length = at->second;
    }
    state_.frame.set_length(a, length);
  }
  frame_changed();
}

void Execution::dwell(double seconds) {
  end_profile();
  emit(Dwell{seconds});
}

}  // namespace servogate::program
