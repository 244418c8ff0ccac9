// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "firmware_if/canopen/306/value_text.hpp"

namespace servogate::gateway::command {

/// The value for JSON: a number, a string, true or false; null where the bytes are no value of the type.
nlohmann::json json_value(std::span<const std::uint8_t> bytes, const canopen::ValueType* type);

}  // namespace servogate::gateway::command
