// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

namespace servogate::gateway::command {

/// Prints an answer to `plc_watch` for people: values by name or beside the source lines, what is forced
/// among them, and times.
void print_sample(const nlohmann::json& answer);

}  // namespace servogate::gateway::command
