// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "report/report.hpp"

namespace servogate::gateway::command {

/// NAME=VALUE of a command line, each. nullopt: one is not of that form, which was said.
std::optional<std::vector<report::ForceEntry>> force_settings(const std::vector<std::string>& words);

}  // namespace servogate::gateway::command
