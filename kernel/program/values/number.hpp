// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace servogate::program {

constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
constexpr bool is_capital(char c) noexcept { return c >= 'A' && c <= 'Z'; }
constexpr bool is_space(char c) noexcept {
  return static_cast<unsigned char>(c) <= ' ' && (c == ' ' || c == '\t' || c == '\r');
}
constexpr bool is_letter(char c) noexcept { return is_capital(c) || (c >= 'a' && c <= 'z'); }
constexpr char capital(char c) noexcept {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

inline std::size_t skip_spaces(std::string_view text, std::size_t pos) noexcept {
  while (pos < text.size() && is_space(text[pos])) ++pos;
  return pos;
}

/// An unsigned decimal number as programs write it: digits, a point, digits; no exponent. Correctly rounded.
struct Decimal {
  double value = 0.0;
  std::size_t length = 0;  ///< characters read, 0: no number stands here
  bool fraction = false;   ///< a point was written
};

/// Reads at `pos` of `text`. Up to 15 digits by exact integer arithmetic (a quotient of two exact doubles is
/// correctly rounded), longer ones by from_chars. real-time safe.
inline Decimal read_decimal(std::string_view text, std::size_t pos) noexcept {
  static constexpr double kPower[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                      1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  Decimal out;
  std::uint64_t mantissa = 0;
  std::size_t i = pos, decimals = 0;
  for (; i < text.size() && is_digit(text[i]); ++i)
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(text[i] - '0');
  std::size_t digits = i - pos;
  if (i < text.size() && text[i] == '.') {
    const std::size_t behind_point = ++i;
    for (; i < text.size() && is_digit(text[i]); ++i)
      mantissa = mantissa * 10 + static_cast<std::uint64_t>(text[i] - '0');
    decimals = i - behind_point;
    digits += decimals;
    out.fraction = true;
  }
  if (digits == 0) return {};
  out.length = i - pos;
  if (digits <= 15)
    out.value = static_cast<double>(mantissa) / kPower[decimals];
  else
    std::from_chars(text.data() + pos, text.data() + i, out.value, std::chars_format::fixed);
  return out;
}

/// A whole number of at most nine digits at `pos`; moves `pos` behind it. -1: none stands here or it is
/// longer.
inline int read_index(std::string_view text, std::size_t& pos) noexcept {
  int value = 0;
  std::size_t digits = 0;
  for (; pos < text.size() && is_digit(text[pos]); ++pos, ++digits)
    if (digits < 9) value = value * 10 + (text[pos] - '0');
  return digits == 0 || digits > 9 ? -1 : value;
}

/// Characters of a UTF-8 text (its bytes without the continuation bytes).
inline std::size_t characters(std::string_view text) noexcept {
  std::size_t n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return n;
}

}  // namespace servogate::program
