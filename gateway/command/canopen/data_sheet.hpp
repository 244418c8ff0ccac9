// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::gateway::command {

/// Reads an EDS or DCF and prints what is odd about it. nullopt: it cannot be read, has no objects or an
/// error, which has been said (exit code kWrongUse).
std::optional<canopen::Eds> read_data_sheet(const std::string& path);

}  // namespace servogate::gateway::command
