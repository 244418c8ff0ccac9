// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <string_view>

#include "firmware_if/image/packets.hpp"

namespace servogate::program {

/// Where an expression gets what it names. Implementations throw ProgramError for what does not exist.
class ValueSource {
 public:
  virtual ~ValueSource() = default;
  virtual double parameter(int index, int column) const = 0;
  virtual double place(const image::Place& place, int column) const = 0;
  /// A value of the control by its number in the language.
  virtual double system(int number, int column) const = 0;
};

struct FunctionRow {
  std::string_view name;
  double (*value)(double a, double b);  ///< NaN: the arguments have no value
  int arguments;
};

struct OperatorRow {
  std::string_view sign;
  int rank;  ///< higher binds closer
  double (*value)(double a, double b);
  bool divides = false;
};

/// The expressions of a language.
struct Expressions {
  std::span<const OperatorRow> operators;  ///< a sign that begins with another one stands before it
  std::span<const FunctionRow> functions;
  std::span<const std::string_view> later;  ///< functions and variables that this version does not evaluate
  std::string_view exponent = {};  ///< between a number and its power of ten, as EX in 2EX-1; empty: none
  bool any_case = false;           ///< small letters are as capitals in names of functions
  /// Reads a variable at `pos` and moves behind it; false: none stands there. `source` null: its form only,
  /// value 1.
  bool (*variable)(std::string_view line, std::size_t& pos, const ValueSource* source, double& value);
};

/// Evaluates an expression that begins at `pos` of `line` and moves `pos` behind it: numbers, signs,
/// brackets, and the operators, functions and variables of the language. `source` null: only the form is
/// judged, every operand counts as 1 and no value is out of range. Throws ProgramError.
double evaluate(const Expressions& language, std::string_view line, std::size_t& pos,
                const ValueSource* source);

}  // namespace servogate::program
