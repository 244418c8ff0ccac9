// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/command/bench/bus_drive.hpp"

/// The commands of `servogate bench`, each with its exit code.
namespace servogate::gateway::command {

int bench_move(const BenchOptions& options);
int bench_jog(const BenchOptions& options);
int bench_run(const BenchOptions& options);
int bench_response(const BenchOptions& options);
int bench_identify(const BenchOptions& options);
int bench_tune(const BenchOptions& options);
int bench_record(const BenchOptions& options);
int bench_positioning(const BenchIsoOptions& options);
int bench_circle(const BenchIsoOptions& options);
int bench_compare(const BenchCompareOptions& options);

/// "position", "velocity", "torque".
bench::Loop loop_named(const std::string& word);
/// A drive led cyclically in this loop alone.
DriveUse use_of_loop(bench::Loop loop);

}  // namespace servogate::gateway::command
