// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/reading/number.hpp"

namespace servogate::program {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

void take_equals(std::string_view line, std::size_t& pos, std::string_view name) {
  pos = skip_spaces(line, pos);
  if (pos >= line.size() || line[pos] != '=') fail(Fault::equals_expected, column(pos), {std::string(name)});
  pos = skip_spaces(line, pos + 1);
}

}  // namespace

void Execution::run_assignments() {
  const std::string_view line = block_.line.substr(0, block_.end);
  for (std::size_t pos = block_.body; pos < line.size(); pos = skip_spaces(line, pos)) {
    std::size_t end = pos;
    while (end < line.size() && is_capital(line[end])) ++end;
    const std::string_view name = line.substr(pos, end - pos);
    if (name == "E")
      assign_parameter(pos);
    else if (name == "SA" || name == "SK" || name == "SYVAR")
      assign_place(pos);
    else
      assign_variable(pos);
  }
}

void Execution::assign_parameter(std::size_t& pos) {
  const std::string_view line = block_.line.substr(0, block_.end);
  const std::size_t start = pos++;
  const int index = read_index(line, pos);
  if (index < 0) fail(Fault::parameter_number_missing, column(pos));
  take_equals(line, pos, line.substr(start, pos - start));
  const double value = evaluate(line, pos, this);
  state_.parameters.set(index, value, column(start));
}

void Execution::assign_place(std::size_t& pos) {
  const std::string_view line = block_.line.substr(0, block_.end);
  const std::size_t start = pos;
  const image::Place target = read_place(line, pos);
  take_equals(line, pos, line.substr(start, pos - start));
  const bool text = target.format == image::Format::ch;
  if (pos < line.size() && line[pos] == '"') {
    if (!text) fail(Fault::text_for_number, column(pos), {image::to_string(target)});
    const std::size_t close = line.find('"', pos + 1);
    if (close == std::string_view::npos) fail(Fault::string_unclosed, column(pos));
    write(target, line.substr(pos + 1, close - pos - 1), column(start));
    pos = close + 1;
  } else if (text) {
    if (pos >= line.size() || line[pos] != 'S')
      fail(Fault::number_for_text, column(pos), {image::to_string(target)});
    const std::size_t from = pos;
    const image::Place other = read_place(line, pos);
    if (other.format != image::Format::ch)
      fail(Fault::number_for_text, column(from), {image::to_string(target)});
    snapshot_used_ = true;
    write(target, characters(other, column(from)), column(start));
  } else {
    const double value = evaluate(line, pos, this);
    write(target, value, column(start));
  }
}

void Execution::assign_variable(std::size_t& pos) {
  const std::string_view line = block_.line.substr(0, block_.end);
  const std::size_t start = pos;
  while (pos < line.size() && (is_capital(line[pos]) || (line[pos] >= 'a' && line[pos] <= 'z'))) ++pos;
  const std::string_view name = line.substr(start, pos - start);
  if (name.empty()) fail(Fault::expected, column(start), {text::both("NAME = value", "ИМЯ = значение")});
  std::size_t digits = pos;
  while (digits < line.size() && is_digit(line[digits])) ++digits;
  const VariableRule* rule = dialect_->find_variable(name);
  if (rule == nullptr)
    fail(Fault::variable_unknown, column(start), {std::string(line.substr(start, digits - start))});
  if (rule->set == nullptr)
    fail(Fault::not_executed, column(start), {std::string(line.substr(start, digits - start))});
  if (rule->indexed) pos = digits;
  take_equals(line, pos, name);
  const int at = column(pos);
  rule->set(*this, evaluate(line, pos, this), at);
}

}  // namespace servogate::program
