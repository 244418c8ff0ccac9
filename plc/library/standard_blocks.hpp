// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::plc::library {

/// The standard function blocks (IEC 61131-3:2013, tables 43 to 46) as Structured Text, compiled with every
/// program; a program may declare its own block of such a name.
std::string standard_blocks();
/// What findings call this source.
inline constexpr const char* kFileName = "<standard>";

}  // namespace servogate::plc::library
