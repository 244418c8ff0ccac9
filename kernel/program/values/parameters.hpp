// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <vector>

namespace servogate::program {

/// The E parameters of a process: one flat set, zero at power-on, typed by their number.
/// Source: NC-110 programmer's manual, table 2.8 (specification B 2.1).
class Parameters {
 public:
  enum class Type { by, in, li, re, lr };
  struct Range {
    std::string_view name;
    double min;
    double max;
  };
  explicit Parameters(int count = 1000) : count_(count) {}

  static constexpr Type type(int index) noexcept {
    return index < 10   ? Type::by
           : index < 20 ? Type::in
           : index < 25 ? Type::li
           : index < 30 ? Type::re
                        : Type::lr;
  }
  static const Range& range(Type type) noexcept;

  int last() const noexcept { return count_ - 1; }
  /// Value of a parameter. Throws ProgramError when it does not exist.
  double get(int index, int column) const;
  /// Stores a value: whole types are rounded to nearest, RE to single precision. Throws ProgramError when it
  /// does not fit or the parameter does not exist.
  void set(int index, double value, int column);

 private:
  void check(int index, int column) const;
  int count_;
  std::vector<double> values_;  ///< as long as the highest parameter written so far
};

}  // namespace servogate::program
