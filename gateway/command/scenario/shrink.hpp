// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "bench/scenario/scenario.hpp"

namespace servogate::gateway::command {

/// The scenario with as few of its drawn steps as still fail, found by leaving out ever smaller groups (delta
/// debugging, Zeller 1999). What is left keeps its times. `fails` runs one.
scenario::Scenario shrink(const scenario::Scenario& failing,
                          const std::function<bool(const scenario::Scenario&)>& fails);

/// The drawn steps of a scenario as [[step]] tables with `at`, for a file.
std::string drawn_steps(const scenario::Scenario& scenario);

}  // namespace servogate::gateway::command
