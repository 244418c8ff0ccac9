// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "machine/keys/document.hpp"
#include "machine/state/state.hpp"

/// Origins and tools as text: the two parts of the state that people edit. Not real-time safe.
namespace servogate::machine {

/// Range of a number of an origin, of a tool, and the largest magnitude of a length, mm or degrees, that
/// people may give; programs may have written others.
inline constexpr int kLastOrigin = 9999, kLastTool = 9999;
inline constexpr double kLongestLife = 1e6;  ///< min
inline constexpr double kLongestEntry = 99'999.999;

/// The last line that the control writes into such a file: one that was cut off lacks it.
inline constexpr std::string_view kTableEnd = "# end";

/// What stands behind the head of the file.
std::string write_table(const MachineState& state, StatePart part);
/// Reads it from a document without syntax errors; each error has its place and names `file`. `axes`: the
/// letters of the machine; empty: any. With an error `state` is half read.
std::vector<text::Finding> read_table(const Document& document, const std::string& file, StatePart part,
                                      const std::vector<std::string>& axes, MachineState& state);

}  // namespace servogate::machine
