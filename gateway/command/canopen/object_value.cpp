// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/object_value.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/306/eds.hpp"

namespace servogate::gateway::command {

nlohmann::json json_value(std::span<const std::uint8_t> bytes, const canopen::ValueType* type) {
  if (type != nullptr && canopen::is_text(*type)) return canopen::text_of(bytes);
  if (type == nullptr || canopen::is_bytes(*type)) return canopen::hex_text(bytes);
  if (!canopen::may_be(bytes, *type)) return nullptr;
  if (canopen::eds_type_real(type->data_type)) {
    const double value = canopen::real_of(bytes);
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  }
  if (type->data_type == 0x01) return bytes[0] != 0;  // BOOLEAN
  if (canopen::eds_type_signed(type->data_type)) return canopen::signed_of(bytes);
  return canopen::load_le(bytes);
}

}  // namespace servogate::gateway::command
