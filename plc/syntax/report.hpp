// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "plc/syntax/ast.hpp"

namespace servogate::plc::syntax {

/// Collects findings. At one place only the first error is kept, so that one mistake is one message.
class Report {
 public:
  explicit Report(std::vector<std::string> file_names, bool warnings = true)
      : files_(std::move(file_names)), warnings_(warnings) {}

  void error(const Location& at, const text::Entry& entry, std::vector<std::string> arguments = {});
  void warning(const Location& at, const text::Entry& entry, std::vector<std::string> arguments = {});
  bool failed() const noexcept { return errors_ > 0; }
  std::size_t errors() const noexcept { return errors_; }
  /// The findings in the order of file, line and column.
  std::vector<text::Finding> take();
  /// After syntax errors: a variable may only seem unused.
  void no_warnings() { warnings_ = false; }
  /// Findings in the standard library's own source are dropped: its file number.
  void hide(int file) { hidden_ = file; }
  const std::vector<std::string>& files() const noexcept { return files_; }

 private:
  struct Item {
    Location at;
    text::Finding finding;
  };
  void add(text::Severity s, const Location& at, const text::Entry& entry,
           std::vector<std::string> arguments);
  std::vector<std::string> files_;
  bool warnings_;
  int hidden_ = -1;
  std::size_t errors_ = 0;
  std::vector<Item> items_;
};

/// ", did you mean 'x'?" for the candidate nearest to a name, or nothing. Used in English and Russian alike
/// as
/// "; 'x'?".
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);
/// A piece of source for a sentence; of a long one the beginning.
std::string cropped(std::string_view source);

}  // namespace servogate::plc::syntax
