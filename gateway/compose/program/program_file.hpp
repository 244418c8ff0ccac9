// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/compose/program/program_model.hpp"
#include "gateway/machine/load.hpp"
#include "kernel/program/interpreter/interpreter.hpp"

namespace servogate::gateway {

/// A part program opened for a machine: everything an interpreter is constructed from but the start position.
struct ProgramFile {
  std::string path;  ///< as it was given; empty: no program, only typed blocks
  std::string dialect, text;
  program::MachineModel model;
  program::ProgramLoader loader;
};

/// The name is one of a language; otherwise it is said on standard error that it is not.
bool known_dialect(const std::string& dialect);

/// Reads the program and settles its dialect (`dialect`, empty: the machine's own). False: a finding says why
/// not, `out` is unchanged but for its dialect. The program's own errors are the interpreter's.
bool open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                  ProgramFile& out, std::vector<text::Finding>& findings);
/// The same for a command: prints the finding, and gives kDone or kWrongUse.
int open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                 ProgramFile& out);

}  // namespace servogate::gateway
