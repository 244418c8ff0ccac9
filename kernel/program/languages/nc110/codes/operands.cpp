// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/codes/operands.hpp"

#include <algorithm>
#include <string>

#include "kernel/program/languages/nc110/faults/texts.hpp"

namespace servogate::program::nc110 {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

/// The items between the brackets, divided by commas outside of quotes and inner brackets.
struct Items {
  std::array<std::pair<std::size_t, std::size_t>, Operands::kMax + 1> at;
  std::size_t count = 0;
};

constexpr struct {
  char kind;
  std::string_view english, russian;
} kKinds[] = {{'n', "whole number or E", "целое число или E"},
              {'x', "number or E", "число или E"},
              {'a', "axis", "ось"},
              {'v', "axis with value", "ось со значением"},
              {'p', "axis with two values", "ось с двумя значениями"},
              {'l', "label", "метка"},
              {'f', "program name", "имя программы"},
              {'w', "condition", "условие"},
              {'k', "axis or K with value", "ось или K со значением"}};

std::string kind_name(char kind) {
  for (const auto& row : kKinds)
    if (row.kind == kind) return text::both(row.english, row.russian);
  return text::both("value", "значение");
}

void add_item(std::string_view line, Items& items, std::size_t from, std::size_t to, std::string_view code) {
  if (items.count == items.at.size()) fail(Wrong::operand_many, column(from), {std::string(code)});
  from = std::min(skip_spaces(line, from), to);
  while (to > from && is_space(line[to - 1])) --to;
  items.at[items.count++] = {from, to};
}

Items split(const Block& block) {
  const std::string_view line = block.line.substr(0, block.end);
  Items items;
  std::size_t from = block.body + 1;
  int depth = 1;
  bool quoted = false;
  for (std::size_t i = from; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '(') ++depth;
    if ((c == ',' && depth == 1) || (c == ')' && --depth == 0)) {
      add_item(line, items, from, i, line.substr(block.body + 1, 3));
      from = i + 1;
      if (depth > 0) continue;
      const std::size_t rest = skip_spaces(line, from);
      if (rest < line.size()) fail(Wrong::after_bracket, column(rest), {std::string(line.substr(rest))});
      return items;
    }
  }
  fail(Fault::bracket_unclosed, column(block.body));
}

class OperandReader {
 public:
  OperandReader(const Dialect& dialect, const AxisLetters& axes, const Items& items, Operands& out)
      : dialect_(dialect), axes_(axes), items_(items), out_(out), line_(out.block->line) {}

  void run(std::string_view signature) {
    std::size_t required = signature.find('?');
    required = std::min(required, signature.size());
    for (std::size_t s = 0; s < signature.size(); ++s) {
      if (signature[s] == '?') continue;
      const char modifier = s + 1 < signature.size() ? signature[s + 1] : '\0';
      const bool repeated = modifier == '+' || modifier == '*';
      const bool needed = s < required && modifier != '*';
      if (next_ == items_.count) {
        if (needed) missing(signature[s]);
      } else {
        do one(signature[s]);
        while (repeated && next_ < items_.count);
      }
      if (repeated) ++s;
    }
    if (next_ < items_.count) fail(Wrong::operand_many, column(items_.at[next_].first), {code()});
  }

 private:
  std::string code() const { return std::string(out_.rule->name); }
  [[noreturn]] void missing(char kind) const {
    const std::size_t at = next_ < items_.count ? items_.at[next_].first : items_.at[items_.count - 1].second;
    fail(Wrong::operand_missing, column(at), {code(), std::to_string(next_), kind_name(kind)});
  }

  void one(char kind) {
    Operand item;
    item.kind = kind;
    item.begin = items_.at[next_].first;
    item.end = items_.at[next_].second;
    if (item.begin == item.end) missing(kind);
    ++next_;
    switch (kind) {
      case 'n':
      case 'x':
        number(item);
        break;
      case 'a':
        axis(item, item.begin);
        break;
      case 'v':
        valued(item, false);
        break;
      case 'p':
        valued(item, true);
        break;
      case 'k':
        if (line_[item.begin] == 'K') {
          std::size_t pos = item.begin + 1;
          item.value = value(pos, item.end, "K", ParameterKind::real);
          if (pos != item.end) unexpected(pos, kind);
        } else {
          valued(item, false);
        }
        break;
      default:
        break;
    }
    if (out_.count == Operands::kMax) fail(Wrong::operand_many, column(item.begin), {code()});
    out_.items[out_.count++] = item;
  }

  void axis(Operand& item, std::size_t& pos) {
    const std::size_t start = item.begin;
    if (!is_capital(line_[start])) fail(Wrong::operand_axis, column(start), {code()});
    if (item.kind == 'a' && item.end != start + 1) fail(Wrong::operand_axis, column(start), {code()});
    item.axis = axes_.find(line_[start]);
    if (item.axis < 0) fail(Fault::axis_missing, column(start), {std::string(1, line_[start])});
    for (std::size_t i = 0; i < out_.count; ++i)
      if (out_.items[i].axis == item.axis)
        fail(Wrong::operand_axis_twice, column(start), {code(), std::string(1, line_[start])});
    std::size_t named = 1;
    for (std::size_t i = 0; i < out_.count; ++i) named += out_.items[i].axis >= 0;
    if (named > kMaxAxesNamed)
      fail(Wrong::operand_axes_many, column(start),
           {code(), std::to_string(named), std::to_string(kMaxAxesNamed)});
    pos = start;
  }

  Value value(std::size_t& pos, std::size_t end, std::string_view word, ParameterKind kind) {
    BlockText text{dialect_, axes_, *out_.block, line_.substr(0, end), pos};
    const Value v = read_value(text, word);
    pos = text.pos;
    if (v.parameter >= 0) check_parameter(dialect_, kind, code(), v);
    return v;
  }

  void number(Operand& item) {
    std::size_t pos = item.begin;
    const ParameterKind kind = item.kind == 'n' ? ParameterKind::whole : ParameterKind::real;
    item.value = value(pos, item.end, code(), kind);
    if (pos != item.end) unexpected(pos, item.kind);
    if (item.kind == 'n' && item.value.parameter < 0 && (item.value.fraction || item.value.negative))
      fail(Fault::whole_number, item.value.column, {code(), std::string(out_.text(item))});
  }

  void valued(Operand& item, bool two) {
    std::size_t pos = item.begin;
    axis(item, pos);
    const std::string_view letter = line_.substr(pos++, 1);
    item.value = value(pos, item.end, letter, ParameterKind::real);
    pos = skip_spaces(line_, pos);
    if (two) {
      if (pos == item.end && next_ < items_.count) {
        pos = items_.at[next_].first;
        item.end = items_.at[next_++].second;
      }
      if (pos >= item.end) fail(Wrong::limits_pair, column(item.begin));
      if (line_[pos] == letter[0]) ++pos;
      item.second = value(pos, item.end, letter, ParameterKind::real);
      pos = skip_spaces(line_, pos);
    }
    if (pos != item.end) unexpected(pos, item.kind);
  }

  [[noreturn]] void unexpected(std::size_t pos, char kind) const {
    fail(Fault::expected, column(pos), {kind_name(kind)});
  }

  static constexpr std::size_t kMaxAxesNamed = 6;
  const Dialect& dialect_;
  const AxisLetters& axes_;
  const Items& items_;
  Operands& out_;
  std::string_view line_;
  std::size_t next_ = 1;
};

const CodeRule* find_code(std::string_view code) {
  const std::span<const CodeRule> all = codes();
  const auto at = std::find_if(all.begin(), all.end(), [&](const CodeRule& row) { return row.name == code; });
  return at == all.end() ? nullptr : &*at;
}

}  // namespace

void read_operands(const Dialect& dialect, const AxisLetters& axes, Block& block, Operands& out) {
  out.block = &block;
  out.count = 0;
  out.column = column(block.body);
  const Items items = split(block);
  const auto [from, to] = items.at[0];
  const std::string_view code = block.line.substr(from, to - from);
  out.rule = find_code(code);
  if (out.rule == nullptr)
    fail(Wrong::code_unknown, column(from),
         {code.empty() ? "()" : std::string(code),
          capitals_hint(code, find_code(in_capitals(code)) != nullptr)});
  if (out.rule->run == nullptr) fail(Fault::not_executed, column(from), {std::string(code)});
  OperandReader(dialect, axes, items, out).run(out.rule->operands);
}

}  // namespace servogate::program::nc110
