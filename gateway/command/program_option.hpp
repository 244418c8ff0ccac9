// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/control/compose/program/program_file.hpp"

namespace servogate::gateway::command {

/// kDone, or kWrongUse after saying that this is the name of no language; empty: none was asked for.
int check_dialect(const std::string& dialect);
/// open_program() for a command: prints the findings, and gives kDone or kWrongUse.
int open_program_or_say(const machine::MachineConfig& machine, const std::string& path,
                        const std::string& dialect, ProgramFile& out);
/// kDone, or kWrongUse after saying that the machine has no such process (from 1).
int check_process(const machine::MachineConfig& machine, int process);

}  // namespace servogate::gateway::command
