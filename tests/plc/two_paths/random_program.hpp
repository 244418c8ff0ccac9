// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace servogate::plc {

/// A valid program in Structured Text chosen by a seed: variables of all numeric types, arrays, structures, a
/// function, a block with VAR_IN_OUT, nested statements. It always ends, but may divide by zero or leave an
/// array.
std::string random_program(std::uint64_t seed);
/// The same chosen by bytes, one for each choice; behind the last one the first of the possible ones is
/// taken.
std::string random_program(std::span<const std::uint8_t> choices);

}  // namespace servogate::plc
