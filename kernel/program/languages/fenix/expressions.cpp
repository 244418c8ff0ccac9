// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"

namespace servogate::program::fenix {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDouble = std::numeric_limits<double>::max();

constexpr ParameterType kTypes[] = {{0, "R", -kDouble, kDouble}};

constexpr OperatorRow kOperators[] = {
    {"<>", 1, [](double a, double b) { return a != b ? 1.0 : 0.0; }},
    {"<", 1, [](double a, double b) { return a < b ? 1.0 : 0.0; }},
    {">", 1, [](double a, double b) { return a > b ? 1.0 : 0.0; }},
    {"=", 1, [](double a, double b) { return a == b ? 1.0 : 0.0; }},
    {"+", 2, [](double a, double b) { return a + b; }},
    {"-", 2, [](double a, double b) { return a - b; }},
    {"*", 3, [](double a, double b) { return a * b; }},
    {"/", 3, [](double a, double b) { return a / b; }, true},
};

/// Angles in degrees; lg to base 10, pw(base, exponent) (specification 24, 5).
constexpr FunctionRow kFunctions[] = {
    {"SIN", [](double a, double) { return sin_deg(a); }, 1},
    {"COS", [](double a, double) { return cos_deg(a); }, 1},
    {"TAN", [](double a, double) { return tan_deg(a); }, 1},
    {"ASIN", [](double a, double) { return std::asin(a) / kDegree; }, 1},
    {"ACOS", [](double a, double) { return std::acos(a) / kDegree; }, 1},
    {"ATAN", [](double a, double) { return std::atan(a) / kDegree; }, 1},
    {"LN", [](double a, double) { return a > 0.0 ? std::log(a) : std::nan(""); }, 1},
    {"LG", [](double a, double) { return a > 0.0 ? std::log10(a) : std::nan(""); }, 1},
    {"PW", [](double a, double b) { return std::pow(a, b); }, 2},
};

/// R7, $24, $zoo (of which the first letter counts).
bool variable(std::string_view line, std::size_t& pos, const ValueSource* source, double& value) {
  const int column = static_cast<int>(pos) + 1;
  const char kind = line[pos];
  if (kind != 'R' && kind != '$') return false;
  std::size_t at = pos + 1;
  const bool digits = at < line.size() && is_digit(line[at]);
  if (kind == 'R' && !digits) return false;
  if (kind == '$' && !digits) {
    if (at == line.size() || !is_letter(line[at])) fail(Fault::parameter_number_missing, column, {"$"});
    const int letter = capital(line[at]) - 'A';
    while (at < line.size() && (is_letter(line[at]) || is_digit(line[at]))) ++at;
    pos = at;
    if (source != nullptr) value = source->parameter(kFirstLetter + letter, column);
    return true;
  }
  const int index = read_index(line, at);
  if (kind == 'R' && (index < 1 || index > kLastR))
    fail(Fault::parameter_absent, column,
         {"R" + std::string(line.substr(pos + 1, at - pos - 1)), "R" + std::to_string(kLastR)});
  pos = at;
  if (source != nullptr)
    value = kind == 'R' ? source->parameter(index, column) : source->system(index, column);
  return true;
}

std::string name_of(int index) {
  if (index < kFirstLetter) return "R" + std::to_string(index);
  return std::string("$") + static_cast<char>('a' + index - kFirstLetter);
}

}  // namespace

Expressions expressions() {
  return {
      .operators = kOperators, .functions = kFunctions, .later = {}, .any_case = true, .variable = variable};
}

ParameterSet parameters() {
  return {.letter = "R",
          .count = kFirstLetter + 26,
          .types = kTypes,
          .whole_numbers = {},
          .real_numbers = {},
          .must_be_set = true,
          .name = name_of};
}

/// $0 to $19 are arguments of the cycle, $20 on values of the control; positions are those reached before the
/// block's motion, of X a diameter where that counts in this block. Source: specification 4.
double system_value(const Execution& run, int number, int column) {
  const State& state = run.state();
  if (number < 20) return run.flow().argument(static_cast<std::size_t>(number));
  switch (number) {
    case 20:
      return state.motion.feed;
    case 21:
      return state.modes.speed;
    case 22:
      return state.modes.motion == Function::rapid ? 0.0 : 1.0;
    case 24:
    case 25:
    case 26:
    case 27:
    case 28: {
      const int axis = run.axes().find("XYZCU"[number - 24]);
      if (axis < 0) fail(Fault::axis_missing, column, {std::string(1, "XYZCU"[number - 24])});
      const auto i = static_cast<std::size_t>(axis);
      const bool diameter = run.machine().axes[i].diameter && state.modes.across == Function::diameter;
      return state.frames.programmed[i] * (diameter ? 2.0 : 1.0);
    }
    case 29:
      return chips(state).on ? 1.0 : 0.0;
    case 30:
      return chips(state).pass;
    case 31:
      return chips(state).back;
    case 32:
      return chips(state).last ? 1.0 : 0.0;
    case 33:
      return chips(state).dwell_s * 1000.0;
    default:
      fail(Fault::not_executed, column, {"$" + std::to_string(number)});
  }
}

}  // namespace servogate::program::fenix
