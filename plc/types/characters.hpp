// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace servogate::plc {

// A STRING holds bytes that are UTF-8, a WSTRING holds units of 16 bits that are UTF-16.

/// Bytes of the UTF-8 character that begins there; 0: it is none. real-time safe.
std::size_t utf8_length(std::string_view s, std::size_t at) noexcept;

/// Takes the character at `at`, which moves behind it. A byte that begins none is the character of its own
/// number (ISO/IEC 10646, row 00), half a surrogate pair is itself. real-time safe.
char32_t take_character(std::string_view s, std::size_t& at) noexcept;
char32_t take_character(std::u16string_view s, std::size_t& at) noexcept;

/// Writes a character as 1 to 4 bytes, or 1 or 2 units; returns how many. Half a surrogate pair becomes
/// U+FFFD in UTF-8. real-time safe.
std::size_t put_character(char32_t c, char* out) noexcept;
std::size_t put_character(char32_t c, char16_t* out) noexcept;

constexpr bool is_surrogate(char32_t c) noexcept { return c >= 0xD800 && c < 0xE000; }

/// The whole text in the other form. Not real-time safe.
std::u16string wide(std::string_view s);
std::string narrow(std::u16string_view s);

}  // namespace servogate::plc
