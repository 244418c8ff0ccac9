// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/units.hpp"

#include "firmware_if/text/finding.hpp"

namespace servogate::text {

namespace {

constexpr struct {
  std::string_view english, russian;
} kUnits[] = {{"mm", "мм"},        {"deg", "град"},       {"mm/s", "мм/с"},
              {"deg/s", "град/с"}, {"mm/s2", "мм/с²"},    {"deg/s2", "град/с²"},
              {"mm/s3", "мм/с³"},  {"deg/s3", "град/с³"}, {"rpm", "об/мин"}};

}  // namespace

std::string unit_words(std::string_view symbol) {
  for (const auto& row : kUnits)
    if (row.english == symbol) return both(row.english, row.russian);
  return std::string(symbol);
}

std::string unit_symbol(std::string_view words) {
  for (const auto& row : kUnits)
    if (row.russian == words) return std::string(row.english);
  return std::string(words);
}

}  // namespace servogate::text
