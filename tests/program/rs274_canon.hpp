// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "tests/program/case_file.hpp"

namespace servogate::program::tests {

/// What LinuxCNC's stand-alone interpreter prints for a program, in the short form of a case file's [rs274]:
/// positions are those of the tool's control point on the machine, in mm. Throws std::runtime_error where it
/// says something unknown.
std::vector<std::string> rs274_steps(const std::string& printed);

/// The same of our own canonical commands, JSON lines of `servogate canon`.
std::vector<std::string> canon_steps(const std::vector<std::string>& lines);

/// The same words, numbers within what four decimals hold.
bool same_step(const std::string& one, const std::string& other);

/// The stand-alone interpreter of this computer, empty where there is none: SERVOGATE_RS274 or `rs274` on the
/// path.
std::string rs274_program();

/// What it prints for the program of a case, with the case's origins and correctors. Throws
/// std::runtime_error where it refuses it.
std::string run_rs274(const std::string& rs274, const CaseFile& c);

}  // namespace servogate::program::tests
