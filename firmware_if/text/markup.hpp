// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace servogate::text {

/// What stands for a character that has a meaning in XML 1.0 and HTML, inside of text and of attributes in
/// double quotes; empty: the character stands for itself. real-time safe.
constexpr std::string_view entity_of(char c) noexcept {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    default:
      return {};
  }
}

/// Words as the text of an element. Not real-time safe.
inline std::string escaped(std::string_view words) {
  std::string out;
  for (const char c : words) {
    const std::string_view entity = entity_of(c);
    entity.empty() ? out += c : out += entity;
  }
  return out;
}

}  // namespace servogate::text
