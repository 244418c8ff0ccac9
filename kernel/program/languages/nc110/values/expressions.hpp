// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::nc110 {

/// The variables, functions and types of E parameters, and E in the place of a number.
Expressions expressions();
ParameterSet parameters();
bool parameter_for_number(BlockText& text, Value& value);
/// T3.12
void read_tool(BlockText& text, Word& word);

}  // namespace servogate::program::nc110
