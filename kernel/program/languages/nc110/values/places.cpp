// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/values/places.hpp"

#include <string>

#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/values/number.hpp"

namespace servogate::program::nc110 {

bool names_place(std::string_view text) {
  return text.starts_with("SA") || text.starts_with("SK") || text.starts_with("SYVAR");
}

image::Place read_place(std::string_view line, std::size_t& pos) {
  const std::size_t start = pos;
  while (pos < line.size() && is_capital(line[pos])) ++pos;
  while (pos < line.size() && is_digit(line[pos])) ++pos;
  if (pos < line.size() && line[pos] == '.') {
    ++pos;
    while (pos < line.size() && is_digit(line[pos])) ++pos;
    const std::size_t format = pos;
    while (pos < line.size() && is_capital(line[pos]) && pos < format + 2) ++pos;
  }
  const std::string_view name = line.substr(start, pos - start);
  const auto place = image::parse_place(name);
  if (!place) fail(Wrong::place_bad, static_cast<int>(start) + 1, {std::string(name)});
  return *place;
}

bool names_signal(std::string_view text, std::size_t pos) {
  if (text.find("RMN", pos) != std::string_view::npos) return true;
  bool quoted = false;
  for (std::size_t i = pos; i + 1 < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted || text[i] != 'S' || (text[i + 1] != 'A' && text[i + 1] != 'K')) continue;
    if (i > pos && is_capital(text[i - 1])) continue;
    if (i + 2 == text.size() || !is_capital(text[i + 2])) return true;
  }
  return false;
}

}  // namespace servogate::program::nc110
