// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "machine/device.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

/// As device files name it.
inline std::string kind_name(DeviceKind kind) {
  return std::string(choices_of<DeviceKind>()[static_cast<std::size_t>(kind)]);
}
/// Its kind was read; otherwise its own findings say enough.
inline bool kind_known(const DeviceConfig& device) { return device.places.contains("kind"); }

}  // namespace servogate::machine
