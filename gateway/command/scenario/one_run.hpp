// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "bench/scenario/scenario.hpp"
#include "bench/scenario/time_line/run.hpp"
#include "gateway/cli/test_options.hpp"
#include "gateway/control/run/session.hpp"

namespace servogate::gateway::command {

/// Puts a machine together and runs one scenario on it; whatever was on is off behind it. `outputs`: trace,
/// report and page of it.
scenario::Outcome run_one(const scenario::Scenario& scenario, const TestOptions& options,
                          const Outputs& outputs = {});

}  // namespace servogate::gateway::command
