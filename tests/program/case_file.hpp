// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "kernel/program/interpreter/interpreter.hpp"

namespace servogate::program::tests {

/// One data-only test (tests/program/README.md): what it runs and what it expects.
struct CaseFile {
  struct Line {
    int number;
    std::string text;
  };
  std::string path;
  std::string name;     ///< file name without .test
  std::string dialect;  ///< whose name begins with that of its folder below tests/program
  MachineModel machine;
  Tables tables;
  Position start{};
  std::string program;
  std::map<std::string, std::string> subprograms;
  std::vector<Line> expected;     ///< [expect]: every command, in order
  std::vector<Line> contained;    ///< [contains]: some of the commands, in order
  std::vector<Line> motions;      ///< [motions]: every motion, in the short form
  std::vector<Line> errors;       ///< [error]: the error that ends the run
  std::vector<Line> findings;     ///< [findings]: all that check finds, in order
  std::vector<Line> rs274;        ///< [rs274]: every step of another interpreter, see rs274_test.cpp
  std::vector<Line> differs;      ///< [differs]: how and why they are not ours
  std::vector<std::string> rows;  ///< [rows]: of the language's checklist, what the case proves

  /// Gives the subprograms; the case outlives it.
  ProgramLoader loader() const;
};

/// Reads a file; throws std::runtime_error with file and line when it is no test.
CaseFile read_case(const std::string& path);

/// All *.test files below a folder, sorted.
std::vector<std::string> case_paths(const std::string& folder);

/// A machine X Y Z with travel of 300 mm to both sides, as examples/mill powers on.
MachineModel mill();

}  // namespace servogate::program::tests
