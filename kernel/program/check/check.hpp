// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/interpreter/interpreter.hpp"

namespace servogate::program {

/// What one run of a program without a machine has shown.
struct CheckReport {
  struct Extent {
    bool moved = false;  ///< a motion command changed this axis
    double min = 0.0;  ///< over all motion, arcs included, the start too; machine coordinates, mm or degrees
    double max = 0.0;
    double travel_min = 0.0;
    double travel_max = 0.0;
    int outside_line = 0;  ///< first line whose motion leaves the travel, 0: none
    int outside_file = 0;  ///< its file, index into `files`
  };
  struct ToolUse {
    int number = 0;
    int corrector = 0;
    int line = 0;  ///< where it is called first
    int calls = 0;
  };
  std::vector<text::Finding> findings;  ///< all that reading gives, in file order, then the warnings and
                                        ///< errors of execution; an error passes over its block
  std::vector<Extent> extents;          ///< index = axis of the machine
  std::vector<ToolUse> tools;           ///< in order of first use
  std::vector<std::string> files;
  double dwell_seconds = 0.0;
  double path_mm = 0.0;    ///< length of all feed motion
  int functions = 0;       ///< M, S and T that the PLC answers; they take what it needs
  int blocks = 0;          ///< blocks in the main program
  long long executed = 0;  ///< blocks executed, loops and subprograms counted as often as they ran
  long long commands = 0;  ///< canonical commands
  int waits = 0;           ///< waits that a dry run passes
  bool finished = false;   ///< the program came to its end
  /// Index in `findings` from which on they are those of the run, not of reading.
  std::size_t of_run = 0;
  /// Index in `findings` of errors that the machine decides on: met after the program had read a place of a
  /// packet, or because it was given up after so many blocks.
  std::vector<std::size_t> by_machine;

  /// True when nothing of severity error was found and the program came to its end.
  bool good() const;
};

/// Sees every command of a dry run. A finding, whose place is filled in by the run, is an error of that
/// command.
using CommandCheck = std::function<std::optional<text::Finding>(const Command&)>;

/// Runs a program to its end without a machine: packets start at zero, own writes take effect in order,
/// NeedsSync is granted at once, waits are passed; after kDryRunBlocks executed blocks more than it has it
/// stops with an error. A motion that leaves the travel is found and the run goes on, so that the extents are
/// those of the whole program. `also` (may be empty) sees each command; `process`
/// (from 0) is that of the interpreter. Not real-time safe. Never throws on
/// bad programs.
CheckReport check_program(std::string_view dialect, const MachineModel& machine, const Tables& tables,
                          const std::string& file_name, const ProgramText& text, const ProgramLoader& loader,
                          const Position& start, const CommandCheck& also = {}, int process = 0);

}  // namespace servogate::program
