// SPDX-License-Identifier: Apache-2.0
#include "plc/types/characters.hpp"

namespace servogate::plc {

namespace {

unsigned byte_at(std::string_view s, std::size_t i) noexcept {
  return static_cast<unsigned>(static_cast<unsigned char>(s[i]));
}
bool first_half(char32_t c) noexcept { return c >= 0xD800 && c < 0xDC00; }
bool second_half(char32_t c) noexcept { return c >= 0xDC00 && c < 0xE000; }

char32_t code_of(std::string_view s, std::size_t at, std::size_t length) noexcept {
  const unsigned lead = byte_at(s, at);
  char32_t code = length == 1 ? lead : lead & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte_at(s, at + i) & 0x3F);
  return code;
}

template <typename To, typename From>
To other_form(From s) {
  To out;
  typename To::value_type units[4];
  for (std::size_t at = 0; at < s.size();) {
    const std::size_t n = put_character(take_character(s, at), units);
    out.append(units, n);
  }
  return out;
}

}  // namespace

std::size_t utf8_length(std::string_view s, std::size_t at) noexcept {
  const unsigned lead = byte_at(s, at);
  const std::size_t n = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
  if (n < 2 || at + n > s.size()) return n == 1 ? 1 : 0;
  for (std::size_t i = 1; i < n; ++i)
    if (byte_at(s, at + i) >> 6 != 2) return 0;
  constexpr char32_t least[] = {0x80, 0x800, 0x10000};
  const char32_t code = code_of(s, at, n);
  return code < least[n - 2] || code > 0x10FFFF || is_surrogate(code) ? 0 : n;
}

char32_t take_character(std::string_view s, std::size_t& at) noexcept {
  const std::size_t length = utf8_length(s, at);
  const char32_t code = length == 0 ? byte_at(s, at) : code_of(s, at, length);
  at += length == 0 ? 1 : length;
  return code;
}

char32_t take_character(std::u16string_view s, std::size_t& at) noexcept {
  const char32_t first = s[at++];
  if (!first_half(first) || at == s.size() || !second_half(s[at])) return first;
  return 0x10000 + ((first - 0xD800) << 10) + (s[at++] - 0xDC00u);
}

std::size_t put_character(char32_t c, char* out) noexcept {
  if (is_surrogate(c)) c = 0xFFFD;
  const std::size_t n = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
  for (std::size_t i = n; i-- > 1; c >>= 6) out[i] = static_cast<char>(0x80 | (c & 0x3F));
  constexpr unsigned char leads[] = {0, 0, 0xC0, 0xE0, 0xF0};
  out[0] = static_cast<char>(leads[n] | c);
  return n;
}

std::size_t put_character(char32_t c, char16_t* out) noexcept {
  if (c < 0x10000) {
    out[0] = static_cast<char16_t>(c);
    return 1;
  }
  out[0] = static_cast<char16_t>(0xD800 + ((c - 0x10000) >> 10));
  out[1] = static_cast<char16_t>(0xDC00 + (c & 0x3FF));
  return 2;
}

std::u16string wide(std::string_view s) { return other_form<std::u16string>(s); }
std::string narrow(std::u16string_view s) { return other_form<std::string>(s); }

}  // namespace servogate::plc
