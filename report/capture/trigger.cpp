// SPDX-License-Identifier: Apache-2.0
#include "report/capture/trigger.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace servogate::report {

namespace {

using Compare = Trigger::Compare;

/// Longer ones first: "<=" begins as "<".
constexpr std::array<std::pair<std::string_view, Compare>, 8> kWords = {{{"<=", Compare::less_equal},
                                                                         {">=", Compare::greater_equal},
                                                                         {"!=", Compare::not_equal},
                                                                         {"<>", Compare::not_equal},
                                                                         {"==", Compare::equal},
                                                                         {"<", Compare::less},
                                                                         {">", Compare::greater},
                                                                         {"=", Compare::equal}}};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<double> number(std::string_view text) {
  if (text == "TRUE" || text == "true") return 1.0;
  if (text == "FALSE" || text == "false") return 0.0;
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::optional<Trigger> parse_trigger(std::string_view text) {
  text = trimmed(text);
  if (text == "alarm") return Trigger{std::string(kAlarmChannel), Compare::rises, 0.0};
  const std::size_t at = text.find_first_of("<>=!");
  if (at == std::string_view::npos) return std::nullopt;
  for (const auto& [word, compare] : kWords) {
    if (text.substr(at, word.size()) != word) continue;
    const std::string_view name = trimmed(text.substr(0, at));
    const auto value = number(trimmed(text.substr(at + word.size())));
    if (name.empty() || !value) return std::nullopt;
    return Trigger{std::string(name), compare, *value};
  }
  return std::nullopt;
}

bool TriggerWatch::met(double value) const {
  switch (trigger_.compare) {
    case Compare::less:
      return value < trigger_.value;
    case Compare::less_equal:
      return value <= trigger_.value;
    case Compare::greater:
      return value > trigger_.value;
    case Compare::greater_equal:
      return value >= trigger_.value;
    case Compare::equal:
      return value == trigger_.value;
    case Compare::not_equal:
      return value != trigger_.value;
    case Compare::rises:
      return begun_ && value > before_;
  }
  return false;
}

bool TriggerWatch::fires(std::span<const double> row) {
  const double value = row[index_];
  const bool is = met(value);
  // A number that rises twice in two cycles has risen twice.
  const bool fires = is && (trigger_.compare == Compare::rises || !was_);
  was_ = is;
  before_ = value;
  begun_ = true;
  return fires;
}

}  // namespace servogate::report
