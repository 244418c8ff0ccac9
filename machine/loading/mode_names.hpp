// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::machine {

struct ModeName {
  std::string_view name;
  canopen::OperationMode mode;
};
inline constexpr ModeName kModes[] = {
    {"pp", canopen::OperationMode::profile_position},
    {"vl", canopen::OperationMode::velocity},
    {"pv", canopen::OperationMode::profile_velocity},
    {"tq", canopen::OperationMode::profile_torque},
    {"hm", canopen::OperationMode::homing},
    {"ip", canopen::OperationMode::interpolated_position},
    {"csp", canopen::OperationMode::cyclic_sync_position},
    {"csv", canopen::OperationMode::cyclic_sync_velocity},
    {"cst", canopen::OperationMode::cyclic_sync_torque},
};

/// A mode of CiA 402 by its name in device files; none: there is no such name.
inline canopen::OperationMode mode_of(std::string_view name) {
  for (const ModeName& m : kModes)
    if (m.name == name) return m.mode;
  return canopen::OperationMode::none;
}

}  // namespace servogate::machine
