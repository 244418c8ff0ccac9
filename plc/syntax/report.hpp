// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "plc/syntax/ast.hpp"

namespace servogate::plc::syntax {

/// Thrown where compiling is to end before its end (Options::stop, a limit that was reported); compile()
/// catches it.
struct Cancelled {};

/// Collects findings. At one place only the first error is kept, so that one mistake is one message; of each
/// severity the first kMost, and how many more there were.
class Report {
 public:
  static constexpr std::size_t kMost = 200;

  explicit Report(std::vector<std::string> file_names, bool warnings = true, std::function<bool()> stop = {})
      : files_(std::move(file_names)), warnings_(warnings), stop_(std::move(stop)) {}

  /// To be called in everything that a long source repeats: throws Cancelled once it is to stop.
  void go_on() const {
    if (stop_ && stop_()) throw Cancelled{};
  }

  void error(const Location& at, const text::Entry& entry, std::vector<std::string> arguments = {});
  void warning(const Location& at, const text::Entry& entry, std::vector<std::string> arguments = {});
  bool failed() const noexcept { return errors_ > 0; }
  std::size_t errors() const noexcept { return errors_; }
  /// More errors are only counted: what would go into their sentences need not be looked for.
  bool full() const noexcept { return kept_[0] >= kMost; }
  /// The findings in the order of file, line and column; behind them, without a place, what was left out.
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
  std::function<bool()> stop_;
  std::size_t errors_ = 0;
  std::size_t kept_[2] = {}, left_out_[2] = {};  ///< errors, warnings
  std::vector<Item> items_;
  std::set<std::tuple<text::Severity, int, int, int>> places_;
};

/// ", did you mean 'x'?" for the candidate nearest to a name, or nothing. Used in English and Russian alike
/// as
/// "; 'x'?".
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);
/// A piece of source for a sentence; of a long one the beginning.
std::string cropped(std::string_view source);

}  // namespace servogate::plc::syntax
