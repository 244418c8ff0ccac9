// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// `[section]` with `key=value` lines, in the order of the file. Lines count from 1.
struct IniEntry {
  std::string key, value;
  int line = 0;
};
struct IniSection {
  std::string name;
  int line = 0;
  std::vector<IniEntry> entries;

  /// Value of a key in any case; empty when there is none.
  std::string_view find(std::string_view key) const noexcept;
  const IniEntry* entry(std::string_view key) const noexcept;
};

/// Findings about one file: at most kMost, then only errors, as many again.
class EdsFindings {
 public:
  static constexpr std::size_t kMost = 500;
  explicit EdsFindings(std::string file) : file_(std::move(file)) {}
  void warn(const text::Entry& entry, int line, std::vector<std::string> arguments = {});
  void error(const text::Entry& entry, int line, std::vector<std::string> arguments = {});
  std::vector<text::Finding> take() { return std::move(findings_); }

 private:
  void add(text::Severity severity, const text::Entry& entry, int line, std::vector<std::string> arguments);
  std::string file_;
  std::vector<text::Finding> findings_;
};

bool valid_utf8(std::string_view bytes) noexcept;
/// Equal but for the case of the letters A-Z.
bool same_word(std::string_view a, std::string_view b) noexcept;

/// Reads a file as vendors write them: any line end, UTF-8, UTF-16 or an eight-bit code page (read as
/// Latin-1), comments with ; # or //, lines without "=", sections that come twice (joined; what came first
/// counts). Values are UTF-8. Never fails.
std::vector<IniSection> read_ini(std::string_view bytes, EdsFindings& findings);

}  // namespace servogate::canopen
