// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/watch/watcher.hpp"

namespace servogate::scenario {

namespace {

std::string value_words(const Value& value) {
  if (const auto* flag = std::get_if<bool>(&value.is)) return *flag ? "on" : "off";
  if (const auto* number = std::get_if<double>(&value.is)) return text::number(*number, 6);
  return std::get<std::string>(value.is);
}

template <class List, class Say>
std::string list(const List& items, const char* between, Say&& say) {
  std::string out;
  for (const auto& item : items) out += (out.empty() ? "" : between) + say(item);
  return out;
}

}  // namespace

std::string words_of(const Condition& c) {
  using Kind = Condition::Kind;
  using Test = Condition::Test;
  const auto numbers = [&] { return list(c.numbers, ", ", [](int n) { return std::to_string(n); }); };
  const auto names = [&] { return list(c.names, ", ", [](const std::string& n) { return n; }); };
  const auto parts = [&](const char* between) {
    return "(" + list(c.parts, between, [](const Condition& p) { return words_of(p); }) + ")";
  };
  switch (c.kind) {
    case Kind::signal: {
      const std::string tolerance = c.tolerance ? " ± " + value_words(*c.tolerance) : "";
      switch (c.test) {
        case Test::equals:
          return c.signal + " = " + value_words(c.value) + tolerance;
        case Test::differs:
          return c.signal + " ≠ " + value_words(c.value) + tolerance;
        case Test::above:
          return c.signal + " > " + value_words(c.value);
        case Test::below:
          return c.signal + " < " + value_words(c.value);
        case Test::at_least:
          return c.signal + " ≥ " + value_words(c.value);
        case Test::at_most:
          return c.signal + " ≤ " + value_words(c.value);
        case Test::between:
          return value_words(c.value) + " ≤ " + c.signal + " ≤ " + value_words(c.upper);
        case Test::rising:
          return c.signal + " ↑";
        case Test::falling:
          return c.signal + " ↓";
        case Test::changes:
          return c.signal + " ↕";
      }
      return c.signal;
    }
    case Kind::alarm:
      return "alarm " + numbers();
    case Kind::no_alarm:
      return c.numbers.empty() ? "no_alarm" : "no_alarm but " + numbers();
    case Kind::standstill:
      return "standstill " + names() + (c.limited ? ", distance ≤ " + value_words(c.value) : "");
    case Kind::path_deviation:
      return "path_deviation ≤ " + value_words(c.value);
    case Kind::reference:
      return "reference " + c.file + " ± " + value_words(c.value);
    case Kind::order:
      return "order " + parts(" → ");
    case Kind::all:
      return parts(" ∧ ");
    case Kind::any:
      return parts(" ∨ ");
  }
  return {};
}

}  // namespace servogate::scenario
