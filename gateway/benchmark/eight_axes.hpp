// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::gateway {

/// Machine file of eight linear axes on three mock segments (three, three and two drives), without a PLC of
/// its own; `plc` names the PLC source.
std::string eight_axis_machine(const std::string& plc);
/// PLC source for it: enables, acknowledgements, and so many simple statements.
std::string eight_axis_logic(int statements);
/// Part program that moves all eight axes together.
std::string eight_axis_program();

}  // namespace servogate::gateway
