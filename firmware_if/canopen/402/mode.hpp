// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/drive_link.hpp"

namespace servogate::canopen {

/// Modes of operation 6060h / display 6061h; the value is also the bit number + 1 in 6502h.
/// Source: CiA 402-2, "Object 6060h: Modes of operation".
enum class OperationMode : std::int8_t {
  none = 0,
  profile_position = 1,
  velocity = 2,
  profile_velocity = 3,
  profile_torque = 4,
  homing = 6,
  interpolated_position = 7,
  cyclic_sync_position = 8,
  cyclic_sync_velocity = 9,
  cyclic_sync_torque = 10,
};

/// Bit of a mode in "Supported drive modes" 6502h; 0 for none, for a manufacturer's mode, and for a reserved
/// number that has no bit there (17 to 127). real-time safe.
constexpr std::uint32_t supported_bit(OperationMode mode) noexcept {
  const int number = static_cast<int>(mode);
  return number >= 1 && number <= 16 ? 1u << (number - 1) : 0u;
}
/// "csp", "pv" ...; "none" for 0, "manufacturer" for negative values. real-time safe.
constexpr const char* short_name(OperationMode mode) noexcept {
  switch (mode) {
    case OperationMode::none:
      return "none";
    case OperationMode::profile_position:
      return "pp";
    case OperationMode::velocity:
      return "vl";
    case OperationMode::profile_velocity:
      return "pv";
    case OperationMode::profile_torque:
      return "tq";
    case OperationMode::homing:
      return "hm";
    case OperationMode::interpolated_position:
      return "ip";
    case OperationMode::cyclic_sync_position:
      return "csp";
    case OperationMode::cyclic_sync_velocity:
      return "csv";
    case OperationMode::cyclic_sync_torque:
      return "cst";
  }
  return "manufacturer";
}

}  // namespace servogate::canopen
