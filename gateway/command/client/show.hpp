// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace servogate::gateway::command {

/// Status as `servogate status` shows it, in the user's language.
void print_status(const nlohmann::json& status);
/// Each first fault with its remedy, what followed from it indented below it.
/// What a start in the middle of a program would do.
void print_restart(const nlohmann::json& plan);
void print_alarms(const nlohmann::json& alarms);
/// What a program waits for, with its remedy; nothing for null.
void print_wait(const nlohmann::json& wait, const std::string& before);

}  // namespace servogate::gateway::command
