// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"

namespace servogate::canopen {

/// Terminals of an I/O module.
struct IoTerminals {
  std::uint8_t digital_inputs = 0;    ///< 0-64
  std::uint8_t digital_outputs = 0;   ///< 0-64
  std::uint8_t analogue_inputs = 0;   ///< 0-12
  std::uint8_t analogue_outputs = 0;  ///< 0-12
};

/// Groups of eight lines.
constexpr std::uint8_t groups(std::uint8_t lines) noexcept {
  return static_cast<std::uint8_t>((lines + 7) / 8);
}

/// 1000h of a module with these terminals. Source: CiA 401-1, "Device type".
std::uint32_t io_device_type(const IoTerminals& terminals) noexcept;

/// The rows 6000h-64FFh, and 1400h-1AFFh with the default PDOs of the profile: RPDO 1 the digital outputs,
/// RPDO 2 to 4 the analogue ones by four; TPDO 1 the digital inputs, TPDO 2 to 4 the analogue ones, all on
/// event. They replace those of communication_objects(). Source: CiA 401-1, "Default PDOs". Not real-time
/// safe.
std::vector<ObjectSpec> io_objects(NodeId node, const IoTerminals& terminals);

}  // namespace servogate::canopen
