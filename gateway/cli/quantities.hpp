// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace servogate::gateway {

/// What an option's number may be, and in which unit people give it.
struct Limits {
  double min = 0.0, max = 0.0;
  std::string unit;    ///< "%", "ms"; both languages by text::both; empty: a bare number
  bool whole = false;  ///< integers only
};

/// A check for an option that says what is wrong, in both languages (text::both): not a number, or outside
/// the limits, which it names with their unit.
CLI::Validator number_within(const Limits& limits);
/// The same for one word of a list. The validator's name is the list, for who writes options down
/// (choices.hpp).
CLI::Validator one_of(std::vector<std::string> words);

}  // namespace servogate::gateway
