// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "gateway/cli/latency_options.hpp"
#include "report/statistics.hpp"

namespace servogate::gateway::command {

/// What the cycle of a whole machine took.
struct MachineCycle {
  std::string machine;       ///< its name
  double cycle_us = 0.0;     ///< its period
  report::CycleTimes times;  ///< how late it began, how long it took, and each of its phases
  std::int64_t missed = 0;   ///< cycles that began when the next one was due already
};

/// Runs the machine of a file, whose parts must all be simulated, in real time: nothing is enabled, its PLC
/// runs. nullptr: it could not be run, which has been said; `code` is the exit code. `ended` is asked
/// meanwhile. Not real-time safe.
std::unique_ptr<MachineCycle> measure_machine(const LatencyOptions& options,
                                              const std::function<bool()>& ended, int& code);

}  // namespace servogate::gateway::command
