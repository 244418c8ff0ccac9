// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/values/expression.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "kernel/program/messages.hpp"
#include "kernel/program/reading/block.hpp"
#include "kernel/program/reading/number.hpp"
#include "kernel/program/values/packet_view.hpp"

namespace servogate::program {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct FunctionRow {
  std::string_view name;
  double (*value)(double a, double b);
  int arguments;
};

double tan_deg(double a) {
  if (std::fmod(std::abs(a), 180.0) == 45.0) return a > 0.0 ? 1.0 : -1.0;
  if (std::fmod(std::abs(a), 180.0) == 135.0) return a > 0.0 ? -1.0 : 1.0;
  const double c = cos_deg(a);
  return c == 0.0 ? std::nan("") : sin_deg(a) / c;
}

/// A result that is no number says that the arguments have no value.
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
/// Functions and variables of the language that this version does not evaluate.
constexpr std::string_view kLater[] = {"FEL", "FEP", "FEC", "TIM", "TOT", "RMN", "IOSTA", "RTA", "RTO"};

class Reader {
 public:
  Reader(std::string_view line, std::size_t& pos, const ValueSource* source)
      : line_(line), pos_(pos), source_(source) {}

  double sum() {
    double value = product();
    for (;;) {
      if (take('+')) {
        value += product();
      } else if (take('-')) {
        value -= product();
      } else {
        return value;
      }
    }
  }

 private:
  int column() const { return static_cast<int>(pos_) + 1; }
  char peek() {
    pos_ = skip_spaces(line_, pos_);
    return pos_ < line_.size() ? line_[pos_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++pos_;
    return true;
  }
  void close() {
    if (!take(')')) fail(Fault::closing_expected, column());
  }

  double product() {
    double value = factor();
    for (;;) {
      if (take('*')) {
        value *= factor();
      } else if (take('/')) {
        const int at = column();
        const double divisor = factor();
        if (divisor == 0.0 && source_ != nullptr) fail(Fault::division_by_zero, at);
        value = divisor == 0.0 ? 1.0 : value / divisor;
      } else {
        return value;
      }
    }
  }

  double factor() {
    bool minus = false;
    for (;;) {
      if (take('-')) {
        minus = !minus;
      } else if (!take('+')) {
        break;
      }
    }
    const double value = primary();
    return minus ? -value : value;
  }

  double primary() {
    const char c = peek();
    if (c == '(') {
      ++pos_;
      const double value = sum();
      close();
      return value;
    }
    if (is_digit(c) || c == '.') {
      const Decimal number = read_decimal(line_, pos_);
      if (number.length == 0) fail(Fault::number_bad, column());
      pos_ += number.length;
      return number.value;
    }
    if (!is_capital(c)) fail(Fault::expression_expected, column());
    return named();
  }

  double named() {
    std::size_t end = pos_;
    while (end < line_.size() && is_capital(line_[end])) ++end;
    const std::string_view name = line_.substr(pos_, end - pos_);
    if (name == "E") return parameter();
    if (name == "SA" || name == "SK" || name == "SYVAR") return place();
    for (const FunctionRow& row : kFunctions)
      if (row.name == name) return function(row);
    for (const std::string_view later : kLater)
      if (later == name) fail(Fault::not_executed, column(), {std::string(name)});
    fail(Fault::function_unknown, column(), {std::string(name)});
  }

  double parameter() {
    const int at = column();
    ++pos_;
    const int index = read_index(line_, pos_);
    if (index < 0) fail(Fault::parameter_number_missing, column());
    return source_ == nullptr ? 1.0 : source_->parameter(index, at);
  }

  double place() {
    const int at = column();
    const image::Place where = read_place(line_, pos_);
    if (where.format == image::Format::ch) fail(Fault::characters_as_number, at, {image::to_string(where)});
    return source_ == nullptr ? 1.0 : source_->place(where, at);
  }

  double function(const FunctionRow& row) {
    const int at = column();
    pos_ += row.name.size();
    if (!take('(')) fail(Fault::expected, column(), {"("});
    const double a = sum();
    double b = 0.0;
    if (row.arguments == 2) {
      if (!take(',')) fail(Fault::comma_expected, column(), {std::string(row.name)});
      b = sum();
    }
    close();
    if (source_ == nullptr) return 1.0;
    const double value = row.value(a, b);
    if (std::isnan(value))
      fail(Fault::domain, at,
           {std::string(row.name), text::number(a) + (row.arguments == 2 ? ", " + text::number(b) : "")});
    return value;
  }

  std::string_view line_;
  std::size_t& pos_;
  const ValueSource* source_;
};

/// Angle brought to 0-360 degrees.
double reduced(double degrees) {
  const double r = std::fmod(degrees, 360.0);
  return r < 0.0 ? r + 360.0 : r;
}

}  // namespace

double sin_deg(double degrees) {
  const double a = reduced(degrees);
  if (a == 0.0 || a == 180.0) return 0.0;
  if (a == 90.0) return 1.0;
  if (a == 270.0) return -1.0;
  if (a == 30.0 || a == 150.0) return 0.5;
  if (a == 210.0 || a == 330.0) return -0.5;
  return std::sin(a * kDegree);
}

double cos_deg(double degrees) { return sin_deg(reduced(degrees) + 90.0); }

double evaluate(std::string_view line, std::size_t& pos, const ValueSource* source) {
  const int column = static_cast<int>(skip_spaces(line, pos)) + 1;
  const double value = Reader(line, pos, source).sum();
  if (!std::isfinite(value)) fail(Fault::not_a_number, column);
  return value;
}

}  // namespace servogate::program
