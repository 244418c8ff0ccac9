// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/device/known_object.hpp"

namespace servogate::gateway::command {

using canopen::address_text;
using canopen::eds_value_text;
using canopen::encode_value;
using canopen::guess_type;
using canopen::hex_text;
using canopen::known_object;
using canopen::may_be;
using canopen::ObjectAddress;
using canopen::parse_address;
using canopen::show_value;
using canopen::type_named;
using canopen::type_numbered;
using canopen::type_words;
using canopen::ValueType;

/// The value for JSON: a number, a string, true or false; null where the bytes are no value of the type.
nlohmann::json json_value(std::span<const std::uint8_t> bytes, const ValueType* type);

}  // namespace servogate::gateway::command
