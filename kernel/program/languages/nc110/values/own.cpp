// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/languages/nc110/values/own.hpp"

#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/profile/definition.hpp"

namespace servogate::program::nc110 {

namespace {

/// Distance to go of an axis of a process. Source: specification A 19.6.
double rest_of(const Execution& run, int process, int ordinal, int column) {
  int met = 0;
  for (int a = 0; a < run.machine().real_axes(); ++a)
    if (run.machine().axes[static_cast<std::size_t>(a)].process == process - 1 && ++met == ordinal)
      return run.to_go(a);
  fail(Wrong::rest_axis, column,
       {"RMN" + std::to_string(process) + std::to_string(ordinal), std::to_string(process),
        std::to_string(met)});
}

}  // namespace

double own_value(const Execution& run, int number, int column) {
  if (number >= kOfRest && number < kOfElement)
    return rest_of(run, (number - kOfRest) / 100, (number - kOfRest) % 100, column);
  if (number == kOfTime) fail(Fault::not_executed, column, {"TIM0"});
  if (number < kOfElement) return run.state().own[static_cast<std::size_t>(number)];
  constexpr char kFunctions[] = {'L', 'P', 'C'};
  const int code = number - kOfElement;
  return element_value(run, kFunctions[code / 100'000], code / 10 % 10'000, code % 10, column);
}

}  // namespace servogate::program::nc110
