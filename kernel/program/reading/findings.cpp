// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/findings.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/reading/number.hpp"

namespace servogate::program {
namespace {

/// Errors, and warnings, that are named of one file: a text of another kind gives one a line, of millions.
constexpr long long kMostFindings = 10'000;

/// Reads one file without executing it.
class FileReader {
 public:
  FileReader(const Execution& run, const Source& source, std::vector<text::Finding>& out)
      : run_(run), source_(source), out_(out) {}

  void read() {
    const std::size_t before = out_.size();
    for (std::uint32_t i = 0; i < source_.lines(); ++i) {
      line_ = static_cast<int>(i) + 1;
      try {
        read_line(i);
      } catch (const ProgramError& error) {
        add(text::Severity::error, error);
      }
    }
    if (source_.lone_return() != Source::kNone) {
      line_ = static_cast<int>(source_.lone_return()) + 1;
      const auto column = static_cast<int>(source_.line(source_.lone_return()).size()) + 1;
      add(text::Severity::warning, {Fault::lone_return, column, {}});
    }
    for (const auto& twice : source_.duplicates()) {
      line_ = static_cast<int>(twice.line) + 1;
      add(text::Severity::warning, {Fault::label_twice,
                                    static_cast<int>(twice.label.data() - source_.line(twice.line).data()),
                                    {std::string(twice.label), std::to_string(twice.first + 1)}});
    }
    for (const Count& count : counts_)
      if (count.found > kMostFindings)
        out_.push_back({text::Severity::warning,
                        source_.path(),
                        count.line,
                        count.column,
                        &entry(Fault::findings_many),
                        {std::to_string(count.found - kMostFindings),
                         &count == &counts_[0] ? text::both("errors", "ошибок")
                                               : text::both("warnings", "предупреждений")}});
    std::stable_sort(out_.begin() + static_cast<std::ptrdiff_t>(before), out_.end(),
                     [](const text::Finding& a, const text::Finding& b) { return a.line < b.line; });
  }

  const std::set<std::string>& called() const { return called_; }

 private:
  void add(text::Severity severity, const ProgramError& error) {
    Count& count = counts_[severity == text::Severity::error ? 0 : 1];
    if (++count.found == kMostFindings + 1) count.line = line_, count.column = error.column;
    if (count.found > kMostFindings) return;
    out_.push_back({severity, source_.path(), line_, error.column, &entry(error.fault), error.arguments});
  }

  void read_line(std::uint32_t index) {
    read_block(run_.dialect(), run_.axes(), source_.line(index), block_);
    if (block_.number >= 0 && std::to_string(block_.number).size() > run_.dialect().max_block_number_digits)
      add(text::Severity::warning,
          {Fault::block_number_long,
           block_.number_column,
           {std::to_string(block_.number), std::to_string(run_.dialect().max_block_number_digits)}});
    if (block_.trailing_comment && block_.kind != BlockKind::empty)
      add(text::Severity::warning,
          {Fault::trailing_comment, static_cast<int>(block_.line.find(';', block_.end)) + 1, {}});
    if (block_.kind == BlockKind::assignments) read_assignments();
    if (block_.kind == BlockKind::code) read_code(index);
  }

  void read_assignments() {
    const std::string_view line = block_.line.substr(0, block_.end);
    for (std::size_t pos = block_.body; pos < line.size(); pos = skip_spaces(line, pos)) {
      const std::size_t start = pos;
      while (pos < line.size() && (is_capital(line[pos]) || (line[pos] >= 'a' && line[pos] <= 'z'))) ++pos;
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
        fail(Fault::text_for_number, static_cast<int>(text) + 1,
             {std::string(line.substr(start, pos - 1 - start))});
      evaluate(line, pos, nullptr);
    }
  }

  void check_variable(std::string_view name, std::string_view line, std::size_t start, std::size_t digits,
                      std::size_t end) const {
    const int column = static_cast<int>(start) + 1;
    if (name.empty()) fail(Fault::expected, column, {text::both("NAME = value", "ИМЯ = значение")});
    if (name == "E") {
      if (digits == end) fail(Fault::parameter_number_missing, static_cast<int>(end) + 1);
      return;
    }
    const VariableRule* rule = run_.dialect().find_variable(name);
    const std::string written(line.substr(start, end - start));
    if (rule == nullptr) fail(Fault::variable_unknown, column, {written});
    if (rule->set == nullptr) fail(Fault::not_executed, column, {written});
  }

  void read_code(std::uint32_t index) {
    read_operands(run_.dialect(), run_.axes(), block_, operands_);
    for (const Operand& item : operands_) {
      const int column = static_cast<int>(item.begin) + 1;
      const std::string_view text = operands_.text(item);
      if (item.kind == 'l' && source_.label(text) == Source::kNone)
        fail(Fault::label_missing, column, {std::string(text)});
      if (item.kind == 'f') called_.insert(std::string(text.substr(0, text.find('/'))));
      if ((item.kind == 'c' || item.kind == 'i') && text.front() != '"') read_value_item(item);
    }
    const bool repeat = operands_.rule->name == "RPT", end = operands_.rule->name == "ERP";
    if ((repeat || end) && source_.repeat_partner(index) == Source::kNone)
      fail(repeat ? Fault::repeat_without_end : Fault::end_without_repeat, operands_.column);
  }

  void read_value_item(const Operand& item) const {
    const std::string_view line = block_.line.substr(0, item.end);
    std::size_t pos = item.begin;
    if (line[pos] == 'S' && (line.substr(pos).starts_with("SA") || line.substr(pos).starts_with("SK") ||
                             line.substr(pos).starts_with("SYVAR"))) {
      if (read_place(line, pos).format == image::Format::ch) return;
      pos = item.begin;
    }
    if (line[pos] >= 'a' && line[pos] <= 'z')
      fail(Fault::not_executed, static_cast<int>(pos) + 1, {std::string(operands_.text(item))});
    evaluate(line, pos, nullptr);
    if (pos != item.end) fail(Fault::expected, static_cast<int>(pos) + 1, {","});
  }

  struct Count {
    long long found = 0;
    int line = 0, column = 0;  ///< of the first that is not named
  };

  const Execution& run_;
  const Source& source_;
  std::vector<text::Finding>& out_;
  std::set<std::string> called_;
  Block block_;
  Operands operands_;
  int line_ = 0;
  Count counts_[2];  ///< errors, warnings
};

}  // namespace

std::vector<text::Finding> find_all(const Execution& run) {
  std::vector<text::Finding> out;
  FileReader main(run, run.main_source(), out);
  main.read();
  std::set<std::string> done;
  std::vector<std::string> open(main.called().begin(), main.called().end());
  while (!open.empty()) {
    const std::string name = open.back();
    open.pop_back();
    if (!done.insert(name).second) continue;
    const auto loaded = run.loader() ? run.loader()(name) : std::nullopt;
    if (!loaded) continue;
    const Source source(name, loaded->text, loaded->path);
    FileReader reader(run, source, out);
    reader.read();
    open.insert(open.end(), reader.called().begin(), reader.called().end());
  }
  return out;
}

}  // namespace servogate::program
