// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "gateway/cli/bench_options.hpp"

namespace servogate::gateway {

/// Adds `bench` with its commands to the command line, filling their options.
void add_bench_commands(CLI::App& app, BenchCommands& options);

}  // namespace servogate::gateway
