// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/caller.hpp"

#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

int axis_of(const machine::MachineConfig& machine, const std::string& letter, FormProblem& problem) {
  const int index = machine.axis_index(letter);
  if (index >= 0) return index;
  std::string list;
  for (const std::string& l : machine.letters()) list += (list.empty() ? "" : ", ") + l;
  problem.entry = &says::kNoAxis;
  problem.arguments = {letter, list};
  return -1;
}

}  // namespace servogate::gateway
