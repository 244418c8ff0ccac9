// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway::command {

/// The code stands behind the sentence, what is to be done on the lines below it.
void print_refusal(const nlohmann::json& reply);
/// Asks the person at the terminal; nullopt: yes. kStopped: no. kWrongUse, and it says so: nobody is
/// there.
std::optional<int> confirmed(const text::Entry& question);

}  // namespace servogate::gateway::command
