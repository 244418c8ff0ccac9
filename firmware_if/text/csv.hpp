// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::text {

/// A field of a CSV file: one with a comma, a quote or a line break is quoted. Source: RFC 4180, section 2.
/// Not real-time safe.
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

}  // namespace servogate::text
