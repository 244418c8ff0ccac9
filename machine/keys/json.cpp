// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/json.hpp"

#include <cmath>
#include <cstdint>

namespace servogate::machine {

Json json_number(double value) {
  constexpr double kExact = 9007199254740992.0;  // 2^53
  if (!std::isfinite(value)) return {};
  if (value == std::floor(value) && std::abs(value) < kExact) return static_cast<std::int64_t>(value);
  return value;
}

std::string written(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace servogate::machine
