// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/codes/own_form.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"

namespace servogate::program::nc110 {
namespace {

/// Reads a block of assignments or a code without executing it.
class Reader {
 public:
  Reader(const Judgement& reading, const Block& block) : reading_(reading), block_(block) {}

  void read() {
    if (block_.line[block_.body] == '(')
      read_code();
    else
      read_assignments();
  }

 private:
  void read_assignments() {
    const std::string_view line = block_.line.substr(0, block_.end);
    for (std::size_t pos = block_.body; pos < line.size(); pos = skip_spaces(line, pos)) {
      const std::size_t start = pos;
      if (defines_element(line, pos)) {
        define_element(nullptr, reading_.run.dialect(), reading_.run.axes(), block_, pos);
        continue;
      }
      while (pos < line.size() && is_letter(line[pos])) ++pos;
      const std::string_view name = line.substr(start, pos - start);
      const bool place = name == "SA" || name == "SK" || name == "SYVAR";
      const std::size_t digits = pos;
      bool characters = false;
      if (place) {
        pos = start;
        characters = read_place(line, pos).format == image::Format::ch;
      } else {
        while (pos < line.size() && is_digit(line[pos])) ++pos;
        check_variable(name, line, start, digits, pos);
      }
      pos = skip_spaces(line, pos);
      if (pos >= line.size() || line[pos] != '=')
        fail(Fault::equals_expected, static_cast<int>(pos) + 1,
             {std::string(line.substr(start, pos - start))});
      ++pos;
      if (characters) return;
      if (const std::size_t text = skip_spaces(line, pos); text < line.size() && line[text] == '"')
        fail(Wrong::text_for_number, static_cast<int>(text) + 1,
             {std::string(line.substr(start, pos - 1 - start))});
      evaluate(reading_.run.dialect().expressions, line, pos, nullptr);
    }
  }

  void check_variable(std::string_view name, std::string_view line, std::size_t start, std::size_t digits,
                      std::size_t end) const {
    const int column = static_cast<int>(start) + 1;
    if (name.empty()) fail(Fault::expected, column, {text::both("NAME = value", "ИМЯ = значение")});
    if (name == "E") {
      if (digits == end) fail(Fault::parameter_number_missing, static_cast<int>(end) + 1, {"E"});
      return;
    }
    const VariableRule* rule = reading_.run.dialect().find_variable(name);
    const std::string written(line.substr(start, end - start));
    if (rule == nullptr) fail(Fault::variable_unknown, column, {written});
    if (rule->set == nullptr) fail(Fault::not_executed, column, {written});
  }

  void read_code() {
    read_operands(reading_.run.dialect(), reading_.run.axes(), block_, operands_);
    for (const Operand& item : operands_) {
      const int column = static_cast<int>(item.begin) + 1;
      const std::string_view text = operands_.text(item);
      if (item.kind == 'l' && reading_.source.label(text) == Source::kNone)
        fail(Fault::label_missing, column, {std::string(text)});
      if (item.kind == 'f') reading_.calls(reading_.where, text.substr(0, text.find('/')));
      if ((item.kind == 'c' || item.kind == 'i') && text.front() != '"') read_value_item(item);
    }
    const bool repeat = operands_.rule->name == "RPT", end = operands_.rule->name == "ERP";
    if ((repeat || end) && reading_.source.repeat_partner(reading_.line) == Source::kNone)
      repeat ? fail(Fault::repeat_without_end, operands_.column, {"RPT", "ERP"})
             : fail(Fault::end_without_repeat, operands_.column, {"ERP", "RPT"});
  }

  void read_value_item(const Operand& item) const {
    const std::string_view line = block_.line.substr(0, item.end);
    std::size_t pos = item.begin;
    if (names_place(line.substr(pos))) {
      if (read_place(line, pos).format == image::Format::ch) return;
      pos = item.begin;
    }
    if (names_element(line.substr(pos))) return;
    evaluate(reading_.run.dialect().expressions, line, pos, nullptr);
    if (pos != item.end) fail(Fault::expected, static_cast<int>(pos) + 1, {","});
  }

  const Judgement& reading_;
  Block block_;
  Operands operands_;
};

}  // namespace

void judge(const Judgement& reading, const Block& block) {
  if (block.kind == BlockKind::own_form) Reader(reading, block).read();
}

}  // namespace servogate::program::nc110
