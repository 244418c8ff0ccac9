// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/codes/own_form.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"

namespace servogate::program::nc110 {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

void take_equals(std::string_view line, std::size_t& pos, std::string_view name) {
  pos = skip_spaces(line, pos);
  if (pos >= line.size() || line[pos] != '=') fail(Fault::equals_expected, column(pos), {std::string(name)});
  pos = skip_spaces(line, pos + 1);
}

void assign_parameter(Execution& run, std::string_view line, std::size_t& pos) {
  const std::size_t start = pos++;
  const int index = read_index(line, pos);
  if (index < 0) fail(Fault::parameter_number_missing, column(pos), {"E"});
  take_equals(line, pos, line.substr(start, pos - start));
  const double value = run.evaluate(pos);
  run.state().parameters.set(index, value, column(start));
}

void assign_characters(Execution& run, const image::Place& target, std::string_view line, std::size_t& pos,
                       int at) {
  if (pos < line.size() && line[pos] == '"') {
    const std::size_t close = line.find('"', pos + 1);
    if (close == std::string_view::npos) fail(Fault::string_unclosed, column(pos));
    run.write(target, line.substr(pos + 1, close - pos - 1), at);
    pos = close + 1;
    return;
  }
  if (pos >= line.size() || line[pos] != 'S')
    fail(Wrong::number_for_text, column(pos), {image::to_string(target)});
  const std::size_t from = pos;
  const image::Place other = read_place(line, pos);
  if (other.format != image::Format::ch)
    fail(Wrong::number_for_text, column(from), {image::to_string(target)});
  run.use_snapshot();
  run.write(target, run.characters(other, column(from)), at);
}

void assign_place(Execution& run, std::string_view line, std::size_t& pos) {
  const std::size_t start = pos;
  const image::Place target = read_place(line, pos);
  take_equals(line, pos, line.substr(start, pos - start));
  if (target.format == image::Format::ch) return assign_characters(run, target, line, pos, column(start));
  if (pos < line.size() && line[pos] == '"')
    fail(Wrong::text_for_number, column(pos), {image::to_string(target)});
  const double value = run.evaluate(pos);
  run.write(target, value, column(start));
}

void assign_variable(Execution& run, std::string_view line, std::size_t& pos) {
  const std::size_t start = pos;
  while (pos < line.size() && is_letter(line[pos])) ++pos;
  const std::string_view name = line.substr(start, pos - start);
  if (name.empty()) fail(Fault::expected, column(start), {text::both("NAME = value", "ИМЯ = значение")});
  std::size_t digits = pos;
  while (digits < line.size() && is_digit(line[digits])) ++digits;
  const VariableRule* rule = run.dialect().find_variable(name);
  if (rule == nullptr)
    fail(Fault::variable_unknown, column(start), {std::string(line.substr(start, digits - start))});
  if (rule->set == nullptr)
    fail(Fault::not_executed, column(start), {std::string(line.substr(start, digits - start))});
  if (rule->indexed) pos = digits;
  take_equals(line, pos, name);
  const int at = column(pos);
  std::size_t number = start + name.size();
  const int index = rule->indexed ? read_index(line, number) : -1;
  rule->set(run, run.evaluate(pos), index, at);
}

void run_assignments(Execution& run) {
  const Block& block = run.block();
  const std::string_view line = block.line.substr(0, block.end);
  for (std::size_t pos = block.body; pos < line.size(); pos = skip_spaces(line, pos)) {
    std::size_t end = pos;
    while (end < line.size() && is_capital(line[end])) ++end;
    const std::string_view name = line.substr(pos, end - pos);
    if (name == "E")
      assign_parameter(run, line, pos);
    else if (defines_element(line, pos))
      define_element(&run, run.dialect(), run.axes(), run.block(), pos);
    else if (name == "SA" || name == "SK" || name == "SYVAR")
      assign_place(run, line, pos);
    else
      assign_variable(run, line, pos);
  }
}

}  // namespace

/// A block of assignments, or a code in brackets.
void own_form(Execution& run) {
  Block& block = run.block();
  if (block.line[block.body] != '(') return run_assignments(run);
  Operands operands;
  read_operands(run.dialect(), run.axes(), block, operands);
  if (!operands.rule->in_contour) {
    if (run.state().profile.open)
      fail(Wrong::profile_open, operands.column, {std::string(operands.rule->name)});
    if (run.contour().engaged())
      fail(Fault::contour_excludes, operands.column, {std::string(operands.rule->name)});
  }
  for (const Operand& item : operands)
    if (item.axis >= 0) run.refuse_barred(item.axis, column(item.begin));
  operands.rule->run(run, operands);
}

bool own_form_waits(const Block& block) {
  const std::string_view text = block.line.substr(0, block.end);
  if (text[block.body] == '(') {
    const std::string_view code = text.substr(skip_spaces(text, block.body + 1)).substr(0, 3);
    return code::orders_records(code) || (code != "WAI" && code != "DER" && names_signal(text, block.body));
  }
  const std::size_t equals = text.find('=', block.body);
  return equals != std::string_view::npos && names_signal(text, equals + 1);
}

LineMark mark(std::string_view line, std::size_t pos) {
  const std::size_t bracket = line.find('(', pos);
  if (bracket == std::string_view::npos) return {};
  const std::string_view code = line.substr(skip_spaces(line, bracket + 1), 3);
  return {code == "RPT"   ? LineMark::Kind::repeat
          : code == "ERP" ? LineMark::Kind::end_of_repeat
                          : LineMark::Kind::none};
}

}  // namespace servogate::program::nc110
