// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/cli/plc_options.hpp"

namespace CLI {
class App;
}

namespace servogate::gateway {

/// Adds `plc` with its commands to the command line, filling `options`.
void add_plc_commands(CLI::App& app, PlcCommands& options);

}  // namespace servogate::gateway
