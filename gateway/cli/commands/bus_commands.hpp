// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway {

/// Adds `can bus`, `drive`, `dump` and `play` to the command line, filling their options.
void add_bus_commands(CLI::App& app, BusCommands& options);

}  // namespace servogate::gateway
