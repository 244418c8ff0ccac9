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

/// The origins and tools with which a program begins: those of a directory, where `folder` is empty the
/// machine's state directory, which a run holds. Empty where there are none; `findings` say what is wrong
/// with them and where, and what people have edited.
program::Tables program_tables(const machine::MachineConfig& machine, const std::string& folder,
                               std::vector<text::Finding>& findings);

/// Subprograms by name: NAME, NAME.nc, name.nc ... in the folder of the main program.
program::ProgramLoader program_loader(const std::string& main_program);

}  // namespace servogate::gateway
