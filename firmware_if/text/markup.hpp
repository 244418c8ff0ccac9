// SPDX-License-Identifier: Apache-2.0
#pragma once
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

}  // namespace servogate::text
