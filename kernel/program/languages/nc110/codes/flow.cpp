// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"

namespace servogate::program::nc110::code {
namespace {

constexpr int kMostRepeats = 99;
constexpr std::size_t kProgramName = 6;  ///< characters

/// One side of a comparison: a number, or characters.
struct Side {
  bool characters = false;
  double number = 0.0;
  std::string text;
};

Side read_side(Execution& run, const Operands& operands, const Operand& item) {
  const std::string_view line = operands.block->line.substr(0, item.end);
  Side side;
  std::size_t pos = item.begin;
  if (line[pos] == '"') {
    side.characters = true;
    side.text = std::string(line.substr(pos + 1, item.end - pos - 2));
    return side;
  }
  if (names_place(line.substr(pos))) {
    const image::Place place = read_place(line, pos);
    if (place.format == image::Format::ch && pos == item.end) {
      side.characters = true;
      side.text = run.characters(place, static_cast<int>(item.begin) + 1);
      return side;
    }
    pos = item.begin;
  }
  side.number = evaluate(run.dialect().expressions, line, pos, &run);
  if (pos != item.end) fail(Fault::expected, static_cast<int>(pos) + 1, {","});
  return side;
}

template <typename T>
bool holds(std::string_view code, const T& a, const T& b) {
  if (code == "BGT") return a > b;
  if (code == "BLT") return a < b;
  if (code == "BEQ") return a == b;
  if (code == "BNE") return a != b;
  if (code == "BGE") return a >= b;
  return a <= b;
}

int column(const Operand& item) { return static_cast<int>(item.begin) + 1; }

/// Not out of a part that EPP runs.
void jump(Execution& run, const Operands& operands, const Operand& label) {
  const std::string_view name = operands.text(label);
  const std::uint32_t target = run.flow().label_line(name, column(label));
  const FlowState& flow = run.state().flow;
  if (flow.part && flow.part->depth == flow.calls.size() &&
      (target < flow.part->first || target > flow.part->last))
    fail(Wrong::jump_out_of_part, column(label), {std::string(name)});
  run.flow().jump(target);
}

}  // namespace

void rpt(Execution& run, const Operands& operands) {
  const Operand& item = operands.items[0];
  const double count = run.numbers().resolve(item.value);
  const int most = kMostRepeats;
  if (!(count >= 0.0 && count <= most) || count != static_cast<int>(count))
    fail(Wrong::repeat_count, column(item), {text::number(count), std::to_string(most)});
  run.flow().repeat(static_cast<int>(count), operands.column);
}

void erp(Execution& run, const Operands& operands) { run.flow().end_repeat(operands.column); }

std::string_view program_name(const Operands& operands, const Operand& item) {
  std::string_view name = operands.text(item);
  name = name.substr(0, name.find('/'));
  const bool good =
      !name.empty() && name.size() <= kProgramName && is_capital(name[0]) &&
      std::all_of(name.begin(), name.end(), [](char c) { return is_capital(c) || is_digit(c); });
  if (!good) fail(Wrong::program_name, column(item), {std::string(name), std::to_string(kProgramName)});
  return name;
}

void cls(Execution& run, const Operands& operands) {
  const Operand& item = operands.items[0];
  run.flow().call(program_name(operands, item), 1, column(item));
}

void epp(Execution& run, const Operands& operands) {
  const Operand &first = operands.items[0], &last = operands.items[1];
  if (run.state().flow.part) fail(Wrong::part_nested, operands.column);
  const std::uint32_t from = run.flow().label_line(operands.text(first), column(first)),
                      to = run.flow().label_line(operands.text(last), column(last));
  if (to < from)
    fail(Wrong::part_reversed, column(first),
         {std::string(operands.text(first)), std::string(operands.text(last))});
  run.flow().run_part(from, to);
}

void bnc(Execution& run, const Operands& operands) { jump(run, operands, operands.items[0]); }

void branch(Execution& run, const Operands& operands) {
  Side a = read_side(run, operands, operands.items[0]);
  Side b = read_side(run, operands, operands.items[1]);
  if (a.characters != b.characters) fail(Wrong::text_compare, column(operands.items[a.characters ? 1 : 0]));
  const std::size_t length = std::max(a.text.size(), b.text.size());
  a.text.resize(length, ' ');
  b.text.resize(length, ' ');
  const std::string_view code = operands.rule->name;
  const bool jumps = a.characters ? holds(code, a.text, b.text) : holds(code, a.number, b.number);
  if (jumps) jump(run, operands, operands.items[2]);
}

}  // namespace servogate::program::nc110::code
