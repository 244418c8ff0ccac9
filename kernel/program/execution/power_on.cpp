// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/execution/own_codes.hpp"

namespace servogate::program {
namespace {

const GRule* mode_of(const Dialect& dialect, const std::string& word) {
  std::size_t pos = 1;
  const int number = word.size() > 1 && word[0] == 'G' ? read_index(word, pos) : -1;
  return number >= 0 && pos == word.size() ? dialect.find_g(number) : nullptr;
}

/// True for what stays in force beyond its block.
bool is_mode(Function function) {
  switch (function) {
    case Function::machine_zero:
    case Function::dwell:
    case Function::exact_once:
    case Function::spindle_mark:
    case Function::own:
    case Function::cycle:
      return false;
    default:
      return true;
  }
}

/// True for what a program has to begin.
bool is_begun(Function function) {
  switch (function) {
    case Function::compensation_left:
    case Function::compensation_right:
    case Function::profile_on:
    case Function::thread:
    case Function::spline:
      return true;
    default:
      return false;
  }
}

void check_range(const std::string& name, double value, double min, double max) {
  if (!(value >= min && value <= max))
    fail(Fault::variable_range, 0, {name, text::number(value), text::number(min), text::number(max)});
}

}  // namespace

/// Modes first, since they tell the units of the values. What is wrong is kept, all of it.
void Execution::apply_power_on() {
  data_.setting_faults.clear();
  data_.power_on_error.reset();
  const auto keep = [&](int mode, const std::string& variable, const ProgramError& error) {
    data_.setting_faults.push_back({mode, variable, error.entry, error.arguments});
    if (!data_.power_on_error) data_.power_on_error = error;
  };
  for (std::size_t i = 0; i < machine_.power_on.size(); ++i) {
    try {
      power_on_mode(i);
    } catch (const ProgramError& error) {
      keep(static_cast<int>(i), {}, error);
    }
  }
  for (const auto& [name, value] : machine_.variables) {
    try {
      power_on_value(name, value);
    } catch (const ProgramError& error) {
      keep(-1, name, error);
    }
  }
  for (std::size_t i = 0; i < machine_.own_codes.size(); ++i) {
    try {
      check_own_code(*data_.language, state_.parameters, machine_.own_codes[i]);
    } catch (const ProgramError& error) {
      keep(-1, {}, error);
      data_.setting_faults.back().own_code = static_cast<int>(i);
    }
  }
}

void Execution::power_on_mode(std::size_t index) {
  const std::string& word = machine_.power_on[index];
  const GRule* rule = mode_of(dialect_, word);
  if (rule == nullptr) fail(Fault::power_on_bad, 0, {word});
  if (rule->function == Function::later) fail(Fault::not_executed, 0, {word});
  if (!is_mode(rule->function)) fail(Fault::power_on_for_block, 0, {word});
  if (is_begun(rule->function)) fail(Fault::power_on_begins, 0, {word});
  for (std::size_t i = 0; i < index; ++i) {
    const GRule* before = mode_of(dialect_, machine_.power_on[i]);
    if (before == rule) fail(Fault::power_on_twice, 0, {word});
    if (before != nullptr && before->group == rule->group)
      fail(Fault::power_on_excluded, 0, {machine_.power_on[i], word});
  }
  BlockWords none;
  none.block = &block_;
  take_g(none, *rule);
  if (rule->take != nullptr) rule->take(*this, none, Word{});
}

/// Positions in a turn of a rotary axis, which the model has taken already.
void Execution::check_index(const std::string& name, double value) const {
  constexpr double kMost = 99999.0;
  const std::string letter = name.substr(dialect_.index_variable.size());
  const int axis = letter.size() == 1 ? data_.axes.find(letter[0]) : -1;
  if (axis < 0 || !machine_.rotary(axis) || !(value >= 1.0 && value <= kMost) || value != std::floor(value))
    fail(Fault::index_count, 0, {name, letter, text::number(kMost)});
}

void Execution::power_on_value(const std::string& name, double value) {
  const ParameterSet& set = dialect_.parameters;
  if (set.count_max > 0 && name == set.letter) return check_range(name, value, set.count_min, set.count_max);
  if (name == "RESOLUTION") return check_range(name, value, 0.0, 1.0);
  if (!dialect_.index_variable.empty() && name.starts_with(dialect_.index_variable))
    return check_index(name, value);
  const VariableRule* rule = dialect_.find_variable(name);
  if (rule == nullptr) fail(Fault::variable_unknown, 0, {name});
  if (rule->set == nullptr) fail(Fault::not_executed, 0, {name});
  rule->set(*this, value, -1, 0);
}

}  // namespace servogate::program
