// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "kernel/program/interpreter/interpreter.hpp"

namespace servogate::program {

/// A program that runs without a machine is stopped with an error when it has executed so many blocks; where
/// only the endless one is looked for (check), so many more than it has.
inline constexpr long long kDryRunBlocks = 1'000'000;

/// Runs an interpreter to its end without a machine and hands over every command: packets start at zero, own
/// writes take effect in order, NeedsSync is granted at once, waits are passed, and after `block_limit`
/// executed blocks it stops with an error. Returns the error that ended the program, nullopt when it came to
/// its end. `on_command` returning false ends the run early (nullopt). `on_error` (may be empty) sees each
/// error; true passes over its block. Not real-time safe.
std::optional<text::Finding> run_dry(Interpreter& interpreter,
                                     const std::function<bool(const Command&)>& on_command,
                                     long long block_limit,
                                     const std::function<bool(const text::Finding&)>& on_error = {});

/// `servogate canon`: one JSON object a line (without line end) for each command, see docs/canon.md. The view
/// is valid during the call only; `line` returning false ends it early. Returns the error that ended the
/// program, nullopt when it came to its end.
std::optional<text::Finding> write_canon(Interpreter& interpreter, const MachineModel& machine,
                                         const std::function<bool(std::string_view)>& line);

}  // namespace servogate::program
