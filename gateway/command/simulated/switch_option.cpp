// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/switch_option.hpp"

#include <charconv>
#include <cmath>

#include "gateway/command/simulated/fault_line.hpp"

namespace servogate::gateway::command {
namespace {

constexpr double kMostRevolutions = 1e6;
constexpr std::string_view kBetween = "..";

/// False: no number in the range of an end; nothing at all is an end that is missing.
bool read_end(std::string_view text, std::optional<double>& end) {
  if (text.empty()) return true;
  double value = 0.0;
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || at != text.data() + text.size()) return false;
  end = value;
  return std::abs(value) <= kMostRevolutions;  // not so of a NaN
}

}  // namespace

mock::DriveSwitch SwitchPlace::at(std::int64_t counts_per_rev) const {
  mock::DriveSwitch s;
  s.input = input;
  const auto turn = static_cast<double>(counts_per_rev);
  if (from_rev) s.from = std::llround(*from_rev * turn);
  if (to_rev) s.to = std::llround(*to_rev * turn);
  return s;
}

std::optional<SwitchPlace> parse_switch(std::string_view words) {
  const std::size_t equals = words.find('='), between = words.find(kBetween);
  if (equals == std::string_view::npos || between == std::string_view::npos || between < equals)
    return std::nullopt;
  const auto input = drive_input(words.substr(0, equals));
  if (!input) return std::nullopt;
  SwitchPlace place{*input, {}, {}};
  if (!read_end(words.substr(equals + 1, between - equals - 1), place.from_rev) ||
      !read_end(words.substr(between + kBetween.size()), place.to_rev))
    return std::nullopt;
  if (!place.from_rev && !place.to_rev) return std::nullopt;
  if (place.from_rev && place.to_rev && *place.from_rev >= *place.to_rev) return std::nullopt;
  return place;
}

}  // namespace servogate::gateway::command
