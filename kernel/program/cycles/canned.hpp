// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/execution/execution.hpp"

namespace servogate::program {

/// One hole of a canned cycle where the other axes stand: at rapid to the level of approach, to the depth
/// with what happens at the bottom, and back. Levels between which nothing is worked, or otherwise than
/// people mean them, are a warning. Throws ProgramError; a step that the cycle's factor brings down to its
/// clearance is one.
void work_hole(Execution& run, Cycle& cycle);

}  // namespace servogate::program
