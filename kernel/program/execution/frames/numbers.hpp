// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "kernel/program/execution/state/machine.hpp"
#include "kernel/program/execution/state/state.hpp"
#include "kernel/program/reading/block.hpp"

namespace servogate::program {

/// What the numbers of words are worth by the parameters, the unit and the dimensions in force.
class Numbers {
 public:
  Numbers(const Dialect& dialect, const MachineModel& machine, const Modes& modes,
          const Parameters& parameters);

  /// Number of a value, its parameter read. Throws ProgramError.
  double resolve(const Value& value) const;
  /// Refuses the value of a word outside of `least` to `most`; where a parameter gave it, its name is said.
  [[noreturn]] void refuse_range(std::string_view word, const Value& value, double number, const char* least,
                                 const char* most) const;
  /// The same as a whole number of at least 0; `word` names it in messages.
  int whole(const Value& value, std::string_view word) const;
  /// A length of an axis in mm, degrees or as a radius, by the unit in force; `halve`: a diameter axis is
  /// halved.
  double length(int axis, const Value& value, bool halve = true) const;
  double unit_factor(int axis) const noexcept;

 private:
  bool as_diameter(const Value& value) const noexcept;
  const Dialect& dialect_;
  const MachineModel& machine_;
  const Modes& modes_;
  const Parameters& parameters_;
  double resolution_;  ///< steps per mm or inch of a programmed coordinate, 0: not rounded
};

}  // namespace servogate::program
