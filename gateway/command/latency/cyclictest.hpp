// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

/// The measuring program of rt-tests, where it is installed. Not real-time safe.
namespace servogate::gateway::command {

struct CyclicTest {
  double min_us = 0.0, mean_us = 0.0, max_us = 0.0;
};
/// The last line of its output that has figures: "T: 0 ( 1234) P:80 I:1000 C:  1000 Min:  2 Act:  5 Avg:  4
/// Max:  31". nullopt: none has.
std::optional<CyclicTest> read_cyclictest(std::string_view output);
/// Runs it so long; nullopt: it is not installed or was refused.
std::optional<CyclicTest> run_cyclictest(double cycle_us, double seconds, int priority);

}  // namespace servogate::gateway::command
