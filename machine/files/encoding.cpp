// SPDX-License-Identifier: Apache-2.0
#include "machine/files/encoding.hpp"

#include <cmath>
#include <utility>

namespace servogate::files {

namespace {

constexpr int kLetters = 32;  ///< а to я, without ё
/// How often each is met in Russian text, of a thousand letters.
constexpr double kPerMille[kLetters] = {80, 16, 45, 17, 30, 85, 9, 16, 74, 12, 35,  44, 32, 67, 110, 28,
                                        47, 55, 63, 26, 3,  10, 5, 14, 7,  4,  0.4, 19, 17, 3,  6,   20};
/// The letters of KOI8-R from C0h on (small; capitals from E0h), as places in the alphabet: ю а б ц ...
constexpr int kKoi8[kLetters] = {30, 0,  1,  22, 4,  5,  20, 3, 21, 8,  9, 10, 11, 12, 13, 14,
                                 15, 31, 16, 17, 18, 19, 6,  2, 28, 27, 7, 24, 29, 25, 23, 26};

struct Letter {
  int place = -1;  ///< in the alphabet, -1: no letter
  bool capital = false;
};

Letter cp1251(int byte) { return byte < 0xC0 ? Letter{} : Letter{(byte - 0xC0) % 32, byte < 0xE0}; }

Letter cp866(int byte) {
  if (byte < 0xB0) return {(byte - 0x80) % 32, byte < 0xA0};
  if (byte >= 0xE0 && byte < 0xF0) return {byte - 0xE0 + 16, false};
  return {};
}

Letter koi8(int byte) { return byte < 0xC0 ? Letter{} : Letter{kKoi8[(byte - 0xC0) % 32], byte >= 0xE0}; }

constexpr struct {
  std::string_view name;
  Letter (*letter)(int byte);
} kEncodings[] = {{"CP1251", cp1251}, {"CP866", cp866}, {"KOI8-R", koi8}};

constexpr double kNoLetter = -8.0;       ///< a character of the upper half that is none
constexpr double kCapitalInside = -2.0;  ///< behind a small letter
constexpr int kFewest = 4;               ///< characters of the upper half
constexpr double kClear = 3.0;           ///< the most likely one is ahead by so much (of e)
constexpr std::size_t kLookedAt = 1 << 20;

double likelihood(std::string_view text, Letter (*letter_of)(int)) {
  double sum = 0.0;
  bool behind_small = false;
  for (const char c : text) {
    const int byte = static_cast<unsigned char>(c);
    const Letter letter = byte < 0x80 ? Letter{} : letter_of(byte);
    if (byte >= 0x80) sum += letter.place < 0 ? kNoLetter : std::log(kPerMille[letter.place] / 1000.0);
    if (letter.place >= 0 && letter.capital && behind_small) sum += kCapitalInside;
    behind_small = letter.place >= 0 && !letter.capital;
  }
  return sum;
}

}  // namespace

int first_line_not_utf8(std::string_view text) {
  int line = 1;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xC2 && lead < 0xE0 ? 2
                               : lead >= 0xE0 && lead < 0xF0 ? 3
                               : lead >= 0xF0 && lead < 0xF5 ? 4
                                                             : 0;
    if (length == 0 || i + length > text.size()) return line;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return line;
    if (lead == '\n') ++line;
    i += length;
  }
  return 0;
}

std::string_view likely_russian_encoding(std::string_view text) {
  text = text.substr(0, kLookedAt);
  int upper = 0;
  for (const char c : text) upper += static_cast<unsigned char>(c) >= 0x80;
  if (upper < kFewest) return {};
  double best = -HUGE_VAL, second = -HUGE_VAL;
  std::string_view name;
  for (const auto& encoding : kEncodings) {
    double sum = likelihood(text, encoding.letter);
    if (sum > best) {
      std::swap(sum, best);
      name = encoding.name;
    }
    if (sum > second) second = sum;
  }
  return best - second >= kClear ? name : std::string_view{};
}

}  // namespace servogate::files
