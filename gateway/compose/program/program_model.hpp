// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/machine/config.hpp"
#include "kernel/program/interpreter/interpreter.hpp"

namespace servogate::gateway {

/// What an interpreter must know of a machine. Places that inputs or the control write are protected.
program::MachineModel program_model(const machine::MachineConfig& machine);

/// Subprograms by name: NAME, NAME.nc, name.nc ... in the folder of the main program.
program::ProgramLoader program_loader(const std::string& main_program);

}  // namespace servogate::gateway
