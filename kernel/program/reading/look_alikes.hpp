// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
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
/// texts and labels. At most a million are told.
std::vector<LookAlike> read_look_alikes(const Lexis& lexis, std::string& text);

}  // namespace servogate::program
