// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "gateway/control/compose/program/program_model.hpp"
#include "kernel/program/interpreter/interpreter.hpp"
#include "machine/load.hpp"

namespace servogate::gateway {

/// A part program opened for a machine: everything an interpreter is constructed from but the start position.
struct ProgramFile {
  std::string path;  ///< as it was given; empty: no program, only typed blocks
  std::string dialect;
  program::ProgramText text;
  int process = 0;  ///< that runs it, from 0
  program::MachineModel model;
  program::ProgramLoader loader;
};

extern const text::Entry kUnknownDialect;  ///< {0} name, {1} known ones

/// The name is one of a language.
bool known_dialect(const std::string& dialect);
/// Names of all languages, for a message.
std::string dialect_names();

/// Reads the program for the process `out.process` and settles its dialect (`dialect`, empty: the machine's
/// own). False: a finding says why
/// not, `out` is unchanged but for its dialect. The program's own errors are the interpreter's.
bool open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                  ProgramFile& out, std::vector<text::Finding>& findings);

}  // namespace servogate::gateway
