// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>

#include "gateway/cli/bench_options.hpp"

namespace servogate::gateway {

/// Adds `bench run` and `bench identify` to the command line, filling their options.
void add_bench_commands(CLI::App& app, BenchOptions& run, BenchOptions& identify);

}  // namespace servogate::gateway
