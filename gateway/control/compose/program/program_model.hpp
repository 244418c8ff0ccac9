// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "kernel/program/interpreter/interpreter.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// What an interpreter of process `process` (from 0) must know of a machine: all axes of programs, so that
/// the ones of other processes are known by name, and its own spindles. Places that inputs or the control
/// write are protected.
program::MachineModel program_model(const machine::MachineConfig& machine, int process);

/// The origins and tools in force with which it begins, as the machine keeps them: a run holds the same
/// directory. Empty where the machine has not been used; a damaged state is the running control's matter.
program::Tables program_tables(const machine::MachineConfig& machine);

/// Subprograms by name: NAME, NAME.nc, name.nc ... in the folder of the main program.
program::ProgramLoader program_loader(const std::string& main_program);

}  // namespace servogate::gateway
