// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::program {

class Execution;

/// Everything that reading alone finds in a program and in the subprograms it names, in file order: at most
/// one error a block, and warnings. Nothing is executed.
std::vector<text::Finding> find_all(const Execution& run);

}  // namespace servogate::program
