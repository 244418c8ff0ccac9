// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::program {

struct Lexis;

/// A Cyrillic letter that was read as the Latin one that it looks like.
struct LookAlike {
  std::uint32_t line = 0;  ///< from 0
  int column = 0;          ///< from 1
  std::string cyrillic;
  std::string_view latin;
};

/// The Latin letter that a Cyrillic one (UTF-8) looks like, empty: none.
std::string_view latin_of(std::string_view cyrillic);

/// The text has letters of the Cyrillic alphabet.
bool any_cyrillic(std::string_view text);

/// Puts Latin letters in the place of Cyrillic words that look like them all through, but not into comments,
/// texts and labels. Takes a text in pieces of whole lines (LF), twice: all of them for its labels, then
/// again.
class LookAlikes {
 public:
  explicit LookAlikes(const Lexis& lexis) : lexis_(&lexis) {}

  /// The first time.
  void collect_labels(std::string_view lines);
  /// The second time: `lines` as they are to be read.
  void read(std::string& lines);
  /// The first letters that were read so, as many as anybody wants to know, and how many there are beside.
  const std::vector<LookAlike>& told() const noexcept { return told_; }
  long long untold() const noexcept { return untold_; }

 private:
  friend class LineOfLookAlikes;
  const Lexis* lexis_;
  std::set<std::string, std::less<>> labels_;  ///< with Cyrillic letters
  std::uint32_t line_ = 0;
  std::vector<LookAlike> told_;
  long long untold_ = 0;
};

}  // namespace servogate::program
