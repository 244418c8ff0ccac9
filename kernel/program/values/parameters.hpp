// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servogate::program {

/// What the parameters from a number on hold.
struct ParameterType {
  int first;
  std::string_view name;
  double min;
  double max;
  bool whole = false;   ///< rounded to the nearest whole number
  bool single = false;  ///< kept in single precision
};

/// The parameters of a language: one flat set of numbers.
struct ParameterSet {
  std::string_view letter;
  int count = 0;      ///< from 0 on, as far as the machine's variables do not say otherwise
  int count_min = 0;  ///< what they may say, by the letter's name; 0: nothing
  int count_max = 0;
  std::span<const ParameterType> types;  ///< by rising number
  /// Numbers below stand for words of ParameterKind::whole, from it on for ParameterKind::real.
  int first_real = 0;
  std::string_view whole_numbers, real_numbers;  ///< both as messages name them
  bool must_be_set = false;                      ///< reading one that nobody has written is an error
  std::string (*name)(int index) = nullptr;      ///< null: the letter and the number

  std::string name_of(int index) const;
};

/// The parameters of a process. Zero, or not set, at power-on.
class Parameters {
 public:
  Parameters() = default;
  Parameters(const ParameterSet& set, int count);

  int last() const noexcept { return count_ - 1; }
  /// Value of a parameter. Throws ProgramError when it does not exist or nobody has set it.
  double get(int index, int column) const;
  /// Stores a value as its type keeps it. Throws ProgramError when it does not fit or the parameter does not
  /// exist.
  void set(int index, double value, int column);

 private:
  void check(int index, int column) const;
  const ParameterSet* set_ = nullptr;
  int count_ = 0;
  std::vector<double> values_;  ///< as long as the highest parameter written so far; NaN: not set
};

}  // namespace servogate::program
