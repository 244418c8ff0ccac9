// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway {

/// Adds `scan`, `sdo`, `od`, `lss` and `nmt` to the command line, filling their options.
void add_canopen_commands(CLI::App& app, BusCommands& options);
/// `can check`, below `can`.
void add_can_check(CLI::App& can, CanCheckOptions& options);

}  // namespace servogate::gateway
