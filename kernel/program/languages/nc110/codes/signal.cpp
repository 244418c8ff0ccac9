// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"

namespace servogate::program::nc110::code {
namespace {

constexpr std::size_t kShownCharacters = 32;
constexpr double kMaxDelay = 32.0;  ///< s, specification B 7.2

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

bool names_value(std::string_view text) {
  for (const std::string_view own : {"TIM", "TOT", "RTA", "RTO"})
    if (text.starts_with(own)) return true;
  return names_place(text) || (text.size() > 1 && text[0] == 'E' && is_digit(text[1]));
}

std::string shown(Execution& run, const Operands& operands, const Operand& item) {
  const std::string_view text = operands.text(item);
  if (text.front() == '"') {
    const std::string_view inner = text.substr(1, text.size() - 2);
    if (characters(inner) > kShownCharacters)
      fail(Wrong::text_long, column(item.begin),
           {std::to_string(characters(inner)), std::to_string(kShownCharacters)});
    return std::string(inner);
  }
  const std::string_view line = operands.block->line.substr(0, item.end);
  std::size_t pos = item.begin;
  if (text.front() == 'S' && names_value(text)) {
    const image::Place place = read_place(line, pos);
    if (place.format == image::Format::ch)
      return std::string(text) + "=" + run.characters(place, column(item.begin));
    pos = item.begin;
  }
  if (names_element(text)) return shown_element(run, text, column(item.begin));
  const double value = evaluate(run.dialect().expressions, line, pos, &run);
  if (pos != item.end) fail(Fault::expected, column(pos), {","});
  return names_value(text) ? std::string(text) + "=" + text::number(value) : text::number(value);
}

Wait::Compare read_compare(const Operands& operands, std::size_t& pos, const image::Place& place) {
  using Compare = Wait::Compare;
  const char c = pos < operands.block->end ? operands.block->line[pos] : '\0';
  if (c != '=' && c != '>' && c != '<' && c != '#') fail(Wrong::wait_form, column(pos));
  if (place.format == image::Format::bl && c != '=') fail(Wrong::wait_bit, column(pos));
  ++pos;
  return c == '=' ? Compare::eq : c == '>' ? Compare::gt : c == '<' ? Compare::lt : Compare::ne;
}

}  // namespace

void dis(Execution& run, const Operands& operands) {
  std::string text;
  for (const Operand& item : operands) {
    if (!text.empty()) text += ' ';
    text += shown(run, operands, item);
  }
  run.emit(Message{std::move(text)});
}

void graphics(Execution& run, const Operands& operands) {
  if (operands.count > 0) {
    const Value& kind = operands.items[0].value;
    const int number = run.numbers().whole(kind, operands.rule->name);
    if (number < 1 || number > 3) run.numbers().refuse_range(operands.rule->name, kind, number, "1", "3");
  }
  Written place = run.capability().written(operands.column);
  run.capability().warn(place, entry(Wrong::graphics), {std::string(operands.rule->name)});
}

void dly(Execution& run, const Operands& operands) {
  const double seconds = run.numbers().resolve(operands.items[0].value);
  if (!(seconds >= 0.0 && seconds <= kMaxDelay))
    fail(Wrong::dwell_range, operands.items[0].value.column,
         {"DLY", text::number(seconds), text::number(kMaxDelay)});
  run.motion().end_profile();
  run.emit(Dwell{seconds});
}

/// Waits for a place; the other form, waiting for a process, needs more than one process.
void wai(Execution& run, const Operands& operands) {
  const Operand& item = operands.items[0];
  const std::string_view line = operands.block->line.substr(0, item.end);
  std::size_t pos = item.begin;
  if (is_digit(line[pos]) || line[pos] == 'E') {
    BlockText text{run.dialect(), run.axes(), *operands.block, line, pos};
    const Value process = read_value(text, "WAI");
    if (text.pos != item.end) fail(Wrong::wait_form, column(text.pos));
    return wait_for_process(run, operands, process);
  }
  if (line[pos] != 'S') fail(Wrong::wait_form, column(pos));
  const image::Place place = read_place(line, pos);
  if (place.format != image::Format::bl && place.format != image::Format::by &&
      place.format != image::Format::in) {
    const std::string text = image::to_string(place);
    fail(Wrong::wait_format, column(item.begin), {text.substr(text.find('.') + 1)});
  }
  Wait wait;
  wait.place = place;
  pos = skip_spaces(line, pos);
  wait.compare = read_compare(operands, pos, place);
  const int value_column = column(pos);
  wait.value = evaluate(run.dialect().expressions, line, pos, &run);
  if (pos != item.end) fail(Wrong::wait_form, column(pos));
  run.check_storable(place, wait.value, value_column);
  run.motion().end_profile();
  run.state().flow.barrier = true;
  run.emit(wait);
}

}  // namespace servogate::program::nc110::code
