// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"
#include "kernel/program/values/number.hpp"

namespace servogate::program::sinumerik {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDouble = std::numeric_limits<double>::max();

constexpr ParameterType kTypes[] = {{0, "REAL", -kDouble, kDouble}};

constexpr double truth(bool holds) { return holds ? 1.0 : 0.0; }

constexpr OperatorRow kOperators[] = {
    {"OR", 0, [](double a, double b) { return truth(a != 0.0 || b != 0.0); }},
    {"AND", 1, [](double a, double b) { return truth(a != 0.0 && b != 0.0); }},
    {"==", 2, [](double a, double b) { return truth(a == b); }},
    {"<>", 2, [](double a, double b) { return truth(a != b); }},
    {"<=", 2, [](double a, double b) { return truth(a <= b); }},
    {">=", 2, [](double a, double b) { return truth(a >= b); }},
    {"<", 2, [](double a, double b) { return truth(a < b); }},
    {">", 2, [](double a, double b) { return truth(a > b); }},
    {"+", 3, [](double a, double b) { return a + b; }},
    {"-", 3, [](double a, double b) { return a - b; }},
    {"*", 4, [](double a, double b) { return a * b; }},
    {"/", 4, [](double a, double b) { return a / b; }, true},
    {"DIV", 4, [](double a, double b) { return std::trunc(a / b); }, true},
    {"MOD", 4, [](double a, double b) { return std::fmod(a, b); }, true},
};

constexpr FunctionRow kFunctions[] = {
    {"SIN", [](double a, double) { return sin_deg(a); }, 1},
    {"COS", [](double a, double) { return cos_deg(a); }, 1},
    {"TAN", [](double a, double) { return tan_deg(a); }, 1},
    {"ASIN", [](double a, double) { return std::asin(a) / kDegree; }, 1},
    {"ACOS", [](double a, double) { return std::acos(a) / kDegree; }, 1},
    {"ATAN2", [](double a, double b) { return std::atan2(a, b) / kDegree; }, 2},
    {"SQRT", [](double a, double) { return a < 0.0 ? std::nan("") : std::sqrt(a); }, 1},
    {"POT", [](double a, double) { return a * a; }, 1},
    {"ABS", [](double a, double) { return std::abs(a); }, 1},
    {"TRUNC", [](double a, double) { return std::trunc(a); }, 1},
    {"ROUND", [](double a, double) { return std::round(a); }, 1},
    {"LN", [](double a, double) { return a > 0.0 ? std::log(a) : std::nan(""); }, 1},
    {"EXP", [](double a, double) { return std::exp(a); }, 1},
};
constexpr std::string_view kLater[] = {"NOT", "XOR"};

/// $C_X, $C_I[0], $AA_MW[X]; other variables of the system are not read in this version.
bool system_variable(std::string_view line, std::size_t& pos, const ValueSource* source, double& value) {
  const int column = static_cast<int>(pos) + 1;
  std::size_t end = pos + 1;
  while (end < line.size() && (is_letter(line[end]) || is_digit(line[end]) || line[end] == '_')) ++end;
  const std::string name = in_capitals(line.substr(pos, end - pos));
  int number = iso::system_number(name, -1);
  if (end < line.size() && line[end] == '[') {
    std::size_t inside = end + 1;
    const bool axis = inside < line.size() && is_letter(line[inside]);
    number = axis ? iso::measured_number(name, capital(line[inside++]))
                  : iso::system_number(name, read_index(line, inside));
    if (inside >= line.size() || line[inside] != ']') fail(Fault::expected, column, {"]"});
    end = inside + 1;
  }
  if (number < 0) fail(iso::Wrong::system_variable, column, {name});
  pos = end;
  if (source != nullptr) value = source->system(number, column);
  return true;
}

/// R7 and variables of the system.
bool variable(std::string_view line, std::size_t& pos, const ValueSource* source, double& value) {
  const int column = static_cast<int>(pos) + 1;
  if (line[pos] == '$') return system_variable(line, pos, source, value);
  std::size_t at = pos + 1;
  if (capital(line[pos]) != 'R' || at == line.size() || !is_digit(line[at])) return false;
  const int index = read_index(line, at);
  if (index < 0 || index >= kRParameters)
    fail(Fault::parameter_absent, column,
         {"R" + std::string(line.substr(pos + 1, at - pos - 1)), "R" + std::to_string(kRParameters - 1)});
  pos = at;
  if (source != nullptr) value = source->parameter(index, column);
  return true;
}

}  // namespace

Expressions expressions() {
  return {.operators = kOperators,
          .functions = kFunctions,
          .later = kLater,
          .exponent = "EX",
          .any_case = true,
          .variable = variable};
}

ParameterSet parameters() {
  return {.letter = "R", .count = kRParameters, .types = kTypes, .whole_numbers = {}, .real_numbers = {}};
}

}  // namespace servogate::program::sinumerik
