// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>

#include "gateway/control/run/running_machine.hpp"

/// What a command says when a machine is about to run.
namespace servogate::gateway::command {

/// Where what a running machine announces goes: standard error.
Announce to_standard_error();
/// HeldState::hold(), saying what it finds; nullptr: `code` is the exit code.
std::unique_ptr<HeldState> hold_state(const std::string& folder, const machine::MachineConfig& machine,
                                      int& code);
/// clock_of(); false: impossible, which has been said.
bool settle_clock(const machine::MachineConfig& machine, ClockKind& clock);
/// RunningMachine::begin(), saying what the system refuses; `quiet`: what it goes on without is not said.
bool begin(RunningMachine& machine, bool quiet = false);

}  // namespace servogate::gateway::command
