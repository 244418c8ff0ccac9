// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway {

/// Adds `modbus` with `read`, `write` and `scan` to the command line, filling their options.
void add_modbus_commands(CLI::App& app, BusCommands& options);

}  // namespace servogate::gateway
