// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/faults.hpp"

namespace servogate::program::fenix {

/// The argument list of a block's word; what is left out is 0, as the guide's own cycles see it
/// (specification 2).
class Arguments {
 public:
  Arguments(const Execution& run, const Word& word) : block_(run.block()), word_(word) {}
  Arguments(const Execution& run, const BlockWords& words) : Arguments(run, *words.instead_word) {}

  bool given(int n) const noexcept {
    return n >= 0 && n < word_.argument_count && !block_.arguments[static_cast<std::size_t>(n)].bare;
  }
  double number(int n, double otherwise = 0.0) const noexcept {
    return given(n) ? block_.arguments[static_cast<std::size_t>(n)].number : otherwise;
  }
  /// The same where 0 means that nothing is given.
  double number_or(int n, double otherwise) const noexcept {
    const double value = number(n);
    return value == 0.0 ? otherwise : value;
  }
  /// Throws where it is missing.
  double required(int n) const {
    if (!given(n)) fail(Wrong::argument_missing, word_.column, {name(), std::to_string(n)});
    return number(n);
  }
  /// Throws where there are more than `most`.
  void at_most(int most) const {
    if (word_.argument_count > most) fail(Wrong::arguments, word_.column, {name(), std::to_string(most)});
  }
  /// Throws for a value below 0, or of 0 where it has to be above.
  double positive(int n, double otherwise, bool above_zero = false) const {
    const double value = number(n, otherwise);
    if (value > 0.0 || (value == 0.0 && !above_zero)) return value;
    fail(above_zero ? Wrong::argument_range : Wrong::argument_negative, word_.column,
         {name(), std::to_string(n), text::number(value)});
  }
  std::string name() const { return "G" + text::number(word_.value.number); }
  int column() const noexcept { return word_.column; }

 private:
  const Block& block_;
  const Word& word_;
};

}  // namespace servogate::program::fenix
