// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/interpreter/findings.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/execution/own_codes.hpp"

namespace servogate::program {
namespace {

/// Errors, and warnings, that are named of one file: a text of another kind gives one a line, of millions.
constexpr long long kMostFindings = 10'000;

/// Reads one file without executing it.
class FileReader {
 public:
  FileReader(const Execution& run, const Dialect& language, const Source& source,
             std::vector<text::Finding>& out)
      : run_(run), source_(source), out_(out) {
    speak(language);
  }

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
      add(text::Severity::warning, Fault::lone_return, column, {});
    }
    for (const LookAlike& letter : source_.look_alikes()) {
      line_ = static_cast<int>(letter.line) + 1;
      add(text::Severity::warning, Fault::cyrillic, letter.column,
          {letter.cyrillic, std::string(letter.latin)});
    }
    counts_[1].found += source_.more_look_alikes();
    for (const auto& twice : source_.duplicates()) {
      line_ = static_cast<int>(twice.line) + 1;
      add(text::Severity::warning, Fault::label_twice,
          static_cast<int>(twice.label.data() - source_.line(twice.line).data()),
          {std::string(twice.label), std::to_string(twice.first + 1)});
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

  /// Names of the programs that it calls, each with the language of the first such block.
  const std::map<std::string, const Dialect*>& called() const { return called_; }

 private:
  void add(text::Severity severity, Fault fault, int column, std::vector<std::string> arguments) {
    add(severity, {&entry(fault), column, std::move(arguments)});
  }
  void add(text::Severity severity, const ProgramError& error) {
    Count& count = counts_[severity == text::Severity::error ? 0 : 1];
    if (++count.found == kMostFindings + 1) count.line = line_, count.column = error.column;
    if (count.found > kMostFindings) return;
    out_.push_back(
        {severity, source_.path(), line_, error.column, dialect_->own(error.entry), error.arguments});
  }

  /// The language of a line may have been changed by the one before it.
  void read_line(std::uint32_t index) {
    const std::string_view line = source_.line(index);
    const auto follow = [&](bool first) {
      if (dialect_->speaks == nullptr) return;
      if (const Dialect* next = dialect_->speaks(run_.machine(), line, first); next != nullptr) speak(*next);
    };
    if (index == 0) follow(true);
    try {
      judge_line(*dialect_, index, line);
    } catch (const ProgramError&) {
      follow(false);
      throw;
    }
    follow(false);
  }

  void speak(const Dialect& language) {
    if (language_ == &language) return;
    language_ = &language;
    extended_ = &language == &run_.language() ? nullptr : with_own_codes(language, run_.machine());
    dialect_ = extended_ != nullptr            ? extended_.get()
               : &language == &run_.language() ? &run_.dialect()
                                               : &language;
  }

  void judge_line(const Dialect& dialect, std::uint32_t index, std::string_view line) {
    read_block(dialect, run_.axes(), line, block_);
    if (block_.number >= 0 && std::to_string(block_.number).size() > dialect.max_block_number_digits)
      add(text::Severity::warning, Fault::block_number_long, block_.number_column,
          {std::to_string(block_.number), std::to_string(dialect.max_block_number_digits)});
    if (block_.trailing_comment && block_.kind != BlockKind::empty && !dialect.lexis.comment_behind_words)
      add(text::Severity::warning, Fault::trailing_comment,
          static_cast<int>(block_.line.find(dialect.lexis.comment, block_.end)) + 1, {});
    if (block_.kind == BlockKind::words) judge_expressions(dialect);
    if (dialect.judge == nullptr || block_.kind == BlockKind::empty) return;
    const auto calls = [](void* where, std::string_view name) {
      auto* reader = static_cast<FileReader*>(where);
      reader->called_.emplace(name, reader->language_);
    };
    dialect.judge({run_, source_, index, calls, this}, block_);
  }

  /// Their form; an expression in brackets has only been skipped so far.
  void judge_expressions(const Dialect& dialect) const {
    const auto judge = [&](const Value& value) {
      std::size_t pos = value.expression - 1u;
      if (value.expression != 0)
        evaluate(dialect.expressions, block_.line.substr(0, block_.end), pos, nullptr);
    };
    for (std::size_t i = 0; i < block_.count; ++i) judge(block_.words[i].value);
    for (std::size_t i = 0; i < block_.argument_count; ++i) judge(block_.arguments[i]);
  }

  struct Count {
    long long found = 0;
    int line = 0, column = 0;  ///< of the first that is not named
  };

  const Execution& run_;
  const Dialect* language_ = nullptr;
  std::shared_ptr<const Dialect> extended_;  ///< with the own codes of the machine
  const Dialect* dialect_ = nullptr;
  const Source& source_;
  std::vector<text::Finding>& out_;
  std::map<std::string, const Dialect*> called_;
  Block block_;
  int line_ = 0;
  Count counts_[2];  ///< errors, warnings
};

}  // namespace

std::vector<text::Finding> find_all(const Execution& run) {
  std::vector<text::Finding> out;
  FileReader main(run, run.language(), run.flow().main_source(), out);
  main.read();
  std::set<std::string> done;
  std::vector<std::pair<std::string, const Dialect*>> open(main.called().begin(), main.called().end());
  while (!open.empty()) {
    const auto [name, language] = open.back();
    open.pop_back();
    if (!done.insert(name).second) continue;
    const auto loaded = run.flow().loader() ? run.flow().loader()(name) : std::nullopt;
    if (!loaded) continue;
    const Source source(run.dialect(), name, loaded->text, loaded->path);
    FileReader reader(run, *language, source, out);
    reader.read();
    open.insert(open.end(), reader.called().begin(), reader.called().end());
  }
  return out;
}

}  // namespace servogate::program
