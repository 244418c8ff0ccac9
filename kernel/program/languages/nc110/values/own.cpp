// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/values/own.hpp"

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"

namespace servogate::program::nc110 {

double own_value(const Execution& run, int number, int column) {
  if (number == kOfTime) fail(Fault::not_executed, column, {"TIM0"});
  if (number < kOfElement) return run.state().own[static_cast<std::size_t>(number)];
  constexpr char kFunctions[] = {'L', 'P', 'C'};
  const int code = number - kOfElement;
  return element_value(run, kFunctions[code / 100'000], code / 10 % 10'000, code % 10, column);
}

}  // namespace servogate::program::nc110
