// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/values/expression.hpp"

#include <cmath>
#include <string>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/values/number.hpp"

namespace servogate::program {
namespace {

class Reader {
 public:
  Reader(const Expressions& language, std::string_view line, std::size_t& pos, const ValueSource* source)
      : language_(language), line_(line), pos_(pos), source_(source) {}

  double binary(int rank) {
    double value = factor();
    for (const OperatorRow* row = next_operator(); row != nullptr && row->rank >= rank;
         row = next_operator()) {
      pos_ += row->sign.size();
      const int at = column();
      const double other = binary(row->rank + 1);
      if (row->divides && other == 0.0) {
        if (source_ != nullptr) fail(Fault::division_by_zero, at);
        value = 1.0;
      } else {
        value = row->value(value, other);
      }
    }
    return value;
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

  const OperatorRow* next_operator() {
    const char c = peek();
    for (const OperatorRow& row : language_.operators) {
      if (row.sign[0] != (is_letter(row.sign[0]) ? capital(c) : c)) continue;
      if (row.sign.size() == 1 || stands(row.sign)) return &row;
    }
    return nullptr;
  }

  /// A sign of several characters; one of letters is a whole word.
  bool stands(std::string_view sign) const {
    if (pos_ + sign.size() > line_.size()) return false;
    for (std::size_t i = 0; i < sign.size(); ++i)
      if ((is_letter(sign[i]) ? capital(line_[pos_ + i]) : line_[pos_ + i]) != sign[i]) return false;
    const std::size_t end = pos_ + sign.size();
    return !is_letter(sign[0]) || end == line_.size() || (!is_letter(line_[end]) && !is_digit(line_[end]));
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
      const double value = binary(0);
      close();
      return value;
    }
    if (is_digit(c) || c == '.') {
      const Decimal number = read_decimal(line_, pos_);
      if (number.length == 0) fail(Fault::number_bad, column());
      pos_ += number.length;
      return number.value * power_of_ten();
    }
    double value = 1.0;
    if (c != '\0' && language_.variable(line_, pos_, source_, value)) return value;
    if (!(language_.any_case ? is_letter(c) : is_capital(c))) fail(Fault::expression_expected, column());
    return named();
  }

  /// What stands behind a number as its power of ten.
  double power_of_ten() {
    constexpr int kMost = 300;
    const std::string_view sign = language_.exponent;
    if (sign.empty() || pos_ + sign.size() > line_.size()) return 1.0;
    for (std::size_t i = 0; i < sign.size(); ++i)
      if (capital(line_[pos_ + i]) != sign[i]) return 1.0;
    std::size_t at = pos_ + sign.size();
    const bool minus = at < line_.size() && line_[at] == '-';
    if (minus || (at < line_.size() && line_[at] == '+')) ++at;
    const int power = read_index(line_, at);
    if (power < 0 || power > kMost) fail(Fault::number_bad, column());
    pos_ = at;
    return std::pow(10.0, minus ? -power : power);
  }

  double named() {
    std::size_t end = pos_;
    while (end < line_.size() && (language_.any_case ? is_letter(line_[end]) : is_capital(line_[end]))) ++end;
    while (language_.any_case && end < line_.size() && is_digit(line_[end])) ++end;
    std::string name(line_.substr(pos_, end - pos_));
    if (language_.any_case) name = in_capitals(name);
    for (const FunctionRow& row : language_.functions)
      if (row.name == name) return function(row);
    for (const std::string_view later : language_.later)
      if (later == name) fail(Fault::not_executed, column(), {name});
    fail(Fault::function_unknown, column(), {std::string(line_.substr(pos_, end - pos_))});
  }

  double function(const FunctionRow& row) {
    const int at = column();
    pos_ += row.name.size();
    if (!take('(')) fail(Fault::expected, column(), {"("});
    const double a = binary(0);
    double b = 0.0;
    if (row.arguments == 2) {
      if (!take(',')) fail(Fault::comma_expected, column(), {std::string(row.name)});
      b = binary(0);
    }
    close();
    if (source_ == nullptr) return 1.0;
    const double value = row.value(a, b);
    if (std::isnan(value))
      fail(Fault::domain, at,
           {std::string(row.name), text::number(a) + (row.arguments == 2 ? ", " + text::number(b) : "")});
    return value;
  }

  const Expressions& language_;
  std::string_view line_;
  std::size_t& pos_;
  const ValueSource* source_;
};

}  // namespace

double evaluate(const Expressions& language, std::string_view line, std::size_t& pos,
                const ValueSource* source) {
  const int column = static_cast<int>(skip_spaces(line, pos)) + 1;
  const double value = Reader(language, line, pos, source).binary(0);
  if (!std::isfinite(value)) fail(Fault::not_a_number, column);
  return value;
}

}  // namespace servogate::program
