// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway {

/// Adds `pendant` with `list` and `watch` to the command line, filling their options.
void add_pendant_commands(CLI::App& app, BusCommands& options);

}  // namespace servogate::gateway
