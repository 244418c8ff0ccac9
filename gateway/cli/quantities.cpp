// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/quantities.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "firmware_if/text/decimal_comma.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

namespace {

std::string quoted(const std::string& word, std::string_view english, std::string_view russian) {
  return text::both("'" + word + "' " + std::string(english), "«" + word + "» " + std::string(russian));
}

/// A unit behind a number in one language.
std::string tail(const std::string& unit, text::Language language) {
  static constexpr text::Entry kArgument{"", "{0}", "{0}"};
  const std::string words = text::render(kArgument, std::vector<std::string>{unit}, language);
  return words.empty() ? "" : " " + words;
}

/// A number without anything behind it; one too large for its type counts as infinite.
bool reads(std::string_view digits, bool whole, double& value) {
  long long integer = 0;
  const char* end = digits.data() + digits.size();
  const std::from_chars_result result =
      whole ? std::from_chars(digits.data(), end, integer) : std::from_chars(digits.data(), end, value);
  if (result.ec == std::errc::invalid_argument || result.ptr != end) return false;
  if (whole) value = static_cast<double>(integer);
  if (result.ec == std::errc::result_out_of_range) value = std::numeric_limits<double>::infinity();
  return true;
}

}  // namespace

CLI::Validator number_within(const Limits& limits) {
  const auto check = [limits](std::string& word) -> std::string {
    double value = 0.0;
    const std::string_view digits = std::string_view(word).substr(word.starts_with('+') ? 1 : 0);
    const bool number = reads(digits, limits.whole, value);
    if (const std::string point = text::with_decimal_point(word); !number && !limits.whole && !point.empty())
      return quoted(word, "has a decimal comma; write " + point, "— десятичная запятая; пишите " + point);
    if (!number)
      return limits.whole ? quoted(word, "is no whole number", "— не целое число")
                          : quoted(word, "is no number", "— не число");
    // False for "nan", too.
    if (value >= limits.min && value <= limits.max) return {};
    const std::string min = text::number(limits.min, 9), max = text::number(limits.max, 9);
    return quoted(word, "is outside " + min + " to " + max + tail(limits.unit, text::Language::english),
                  "вне пределов от " + min + " до " + max + tail(limits.unit, text::Language::russian));
  };
  return {check, ""};
}

CLI::Validator one_of(std::vector<std::string> words) {
  std::string names;
  for (const std::string& word : words) names += (names.empty() ? "" : " ") + word;
  const auto check = [words = std::move(words)](std::string& word) -> std::string {
    if (std::find(words.begin(), words.end(), word) != words.end()) return {};
    std::string list;
    for (const std::string& w : words) list += (list.empty() ? "" : ", ") + w;
    return quoted(word, "is not one of " + list, "не входит в список: " + list);
  };
  return {check, "", names};
}

}  // namespace servogate::gateway
