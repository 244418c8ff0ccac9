// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/expressions.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"
#include "kernel/program/languages/nc110/values/places.hpp"
#include "kernel/program/reading/block.hpp"

/// Source: NC-110 programmer's manual, "E parameters", table 2.8 (specification B 2.1, B 2.2).
namespace servogate::program::nc110 {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFloat = static_cast<double>(std::numeric_limits<float>::max());
constexpr double kDouble = std::numeric_limits<double>::max();

constexpr ParameterType kTypes[] = {{0, "BY", 0, 255, true},
                                    {10, "IN", -32768, 32767, true},
                                    {20, "LI", -2147483648.0, 2147483647, true},
                                    {25, "RE", -kFloat, kFloat, false, true},
                                    {30, "LR", -kDouble, kDouble}};

constexpr OperatorRow kOperators[] = {
    {"+", 1, [](double a, double b) { return a + b; }},
    {"-", 1, [](double a, double b) { return a - b; }},
    {"*", 2, [](double a, double b) { return a * b; }},
    {"/", 2, [](double a, double b) { return a / b; }, true},
};

constexpr FunctionRow kFunctions[] = {
    {"SIN", [](double a, double) { return sin_deg(a); }, 1},
    {"COS", [](double a, double) { return cos_deg(a); }, 1},
    {"TAN", [](double a, double) { return tan_deg(a); }, 1},
    {"ARS", [](double a, double) { return std::asin(a) / kDegree; }, 1},
    {"ARC", [](double a, double) { return std::acos(a) / kDegree; }, 1},
    {"ART", [](double a, double) { return std::atan(a) / kDegree; }, 1},
    {"SQR", [](double a, double) { return a < 0.0 ? std::nan("") : std::sqrt(a); }, 1},
    {"ABS", [](double a, double) { return std::abs(a); }, 1},
    {"INT", [](double a, double) { return std::trunc(a); }, 1},
    {"NEG", [](double a, double) { return -a; }, 1},
    {"MOD", [](double a, double b) { return b == 0.0 ? std::nan("") : std::fmod(a, b); }, 2},
};

/// FEL(A,B): a value of a geometric element.
double of_element(int function, std::string_view line, std::size_t& pos, const ValueSource* source,
                  int column) {
  const auto take = [&](char c) {
    pos = skip_spaces(line, pos);
    if (pos >= line.size() || line[pos] != c)
      fail(Fault::expected, static_cast<int>(pos) + 1, {std::string(1, c)});
    ++pos;
  };
  take('(');
  const double number = evaluate(expressions(), line, pos, source);
  take(',');
  const double item = evaluate(expressions(), line, pos, source);
  take(')');
  if (source == nullptr) return 1.0;
  const auto whole = [&](double value, double most) {
    if (!(value >= 0.0 && value <= most) || value != std::floor(value))
      fail(Wrong::element_number, column, {text::number(most)});
    return static_cast<int>(value);
  };
  return source->system(kOfElement + function * 100'000 + whole(number, 255) * 10 + whole(item, 9), column);
}

/// A variable of the language's own: TIM2, RMS.
bool own_variable(std::string_view name, std::string_view line, std::size_t& pos, const ValueSource* source,
                  double& value, int column) {
  if (name == "FEL" || name == "FEP" || name == "FEC") {
    pos += name.size();
    value = of_element(name == "FEL" ? 0 : name == "FEP" ? 1 : 2, line, pos, source, column);
    return true;
  }
  if (name == "RMN") {
    pos += name.size();
    const std::size_t digits = pos;
    const int number = read_index(line, pos);
    if (pos - digits != 2 || number < 11 || number > 59 || number % 10 == 0)
      fail(Wrong::rest_form, column,
           {std::string(line.substr(digits - name.size(), pos - digits + name.size()))});
    if (source != nullptr) value = source->system(kOfRest + number / 10 * 100 + number % 10, column);
    return true;
  }
  const bool time = name == "TIM", sum = name == "TOT";
  if (!time && !sum && name != "RTA" && name != "RTO" && name != "IOSTA") return false;
  pos += name.size();
  std::size_t place = at(name == "RTA" ? Own::rta : name == "RTO" ? Own::rto : Own::iosta);
  if (time || sum) {
    const int index = read_index(line, pos);
    if (index < 0 || index > kMostTimer)
      fail(Wrong::timer_index, column, {std::string(name), "0", std::to_string(kMostTimer)});
    place = at(time ? Own::tim : Own::tot) + static_cast<std::size_t>(index);
    if (time && index == 0) place = kOfTime;
  }
  if (source != nullptr) value = source->system(static_cast<int>(place), column);
  return true;
}

/// E parameters and places.
bool variable(std::string_view line, std::size_t& pos, const ValueSource* source, double& value) {
  std::size_t end = pos;
  while (end < line.size() && is_capital(line[end])) ++end;
  const std::string_view name = line.substr(pos, end - pos);
  const int column = static_cast<int>(pos) + 1;
  if (name == "E") {
    ++pos;
    const int index = read_index(line, pos);
    if (index < 0) fail(Fault::parameter_number_missing, static_cast<int>(pos) + 1, {"E"});
    if (source != nullptr) value = source->parameter(index, column);
    return true;
  }
  if (name != "SA" && name != "SK" && name != "SYVAR")
    return own_variable(name, line, pos, source, value, column);
  const image::Place where = read_place(line, pos);
  if (where.format == image::Format::ch) fail(Fault::characters_as_number, column, {image::to_string(where)});
  if (source != nullptr) value = source->place(where, column);
  return true;
}

}  // namespace

Expressions expressions() {
  return {.operators = kOperators, .functions = kFunctions, .later = {}, .variable = variable};
}

ParameterSet parameters() {
  return {.letter = "E",
          .count = 1000,
          .count_min = 31,
          .count_max = 10000,
          .types = kTypes,
          .first_real = 25,
          .whole_numbers = "E0-E24",
          .real_numbers = "E25-E29 / E30..."};
}

bool parameter_for_number(BlockText& text, Value& value) {
  if (text.line[text.pos] != 'E') return false;
  std::size_t at = text.pos + 1;
  const int index = read_index(text.line, at);
  if (index < 0) fail(Fault::parameter_number_missing, static_cast<int>(at) + 1, {"E"});
  value.parameter = static_cast<std::int16_t>(std::min(index, 32767));
  text.pos = at;
  return true;
}

/// T and its corrector: the fraction is a number of its own, .1 and .10 are different correctors.
void read_tool(BlockText& text, Word& word) {
  const std::string_view line = text.line;
  const std::size_t start = word.column - 1u;
  const auto bad = [&] {
    std::size_t end = line.find_first_of(" \t;", start);
    end = std::min(end, line.size());
    fail(Wrong::tool_form, word.column, {std::string(line.substr(start, end - start))});
  };
  const auto part = [&](Value& value) {
    value.column = static_cast<std::uint16_t>(text.column());
    if (text.pos < line.size() && line[text.pos] == 'E') {
      std::size_t at = text.pos + 1;
      if (read_index(line, at) < 0) bad();
      parameter_for_number(text, value);
      return check_parameter(text.dialect, ParameterKind::whole, "T", value);
    }
    const std::size_t digits = text.pos;
    const int number = read_index(line, text.pos);
    if (number < 0 || text.pos - digits > 4) bad();
    value.number = number;
  };
  part(word.value);
  text.block.corrector = Value{};
  if (text.pos < line.size() && line[text.pos] == '.') {
    ++text.pos;
    part(text.block.corrector);
  }
}

}  // namespace servogate::program::nc110
