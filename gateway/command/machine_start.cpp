// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/machine_start.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/control/run/exit_code.hpp"

namespace servogate::gateway::command {

Announce to_standard_error() {
  return
      [](const text::Entry& entry, const std::vector<std::string>& arguments) { complain(entry, arguments); };
}

std::unique_ptr<HeldState> hold_state(const std::string& folder, const machine::MachineConfig& machine,
                                      int& code) {
  drivers::Notice taken;
  std::vector<text::Finding> findings;
  auto state = HeldState::hold(folder, machine.letters(), taken, findings);
  print_findings(findings);
  if (state != nullptr) return state;
  code = taken.entry != nullptr ? kInfrastructure : kWrongUse;
  if (taken.entry != nullptr) complain(*taken.entry, taken.arguments);
  return nullptr;
}

bool settle_clock(const machine::MachineConfig& machine, ClockKind& clock) {
  drivers::Notice refusal;
  clock = clock_of(machine, clock, refusal);
  if (refusal.entry != nullptr) complain(*refusal.entry, refusal.arguments);
  return clock != ClockKind::unset;
}

bool begin(RunningMachine& machine, bool quiet) {
  std::vector<drivers::Notice> refusals;
  const bool begun = machine.begin(refusals);
  for (const drivers::Notice& r : refusals)
    if (!begun || !quiet) complain(*r.entry, r.arguments);
  return begun;
}

}  // namespace servogate::gateway::command
