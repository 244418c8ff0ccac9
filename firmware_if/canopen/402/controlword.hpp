// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/drive_link.hpp"

namespace servogate::canopen {

/// Bits and commands of the controlword 6040h. Source: CiA 402-2, "Object 6040h: Controlword", table "Command
/// coding".
namespace controlword {
inline constexpr std::uint16_t kSwitchOn = 1u << 0, kEnableVoltage = 1u << 1,
                               kQuickStop = 1u << 2,       ///< 0 = quick stop
    kEnableOperation = 1u << 3, kModeSpecific4 = 1u << 4,  ///< pp: new set-point; homing: start
    kModeSpecific5 = 1u << 5, kModeSpecific6 = 1u << 6, kFaultReset = 1u << 7, kHalt = 1u << 8;

inline constexpr std::uint16_t kCommandShutdown = 0x0006;
inline constexpr std::uint16_t kCommandSwitchOn = 0x0007;
inline constexpr std::uint16_t kCommandEnableOperation = 0x000F;
inline constexpr std::uint16_t kCommandDisableOperation = 0x0007;
inline constexpr std::uint16_t kCommandDisableVoltage = 0x0000;
inline constexpr std::uint16_t kCommandQuickStop = 0x0002;
inline constexpr std::uint16_t kCommandFaultReset = 0x0080;
}  // namespace controlword

/// What a controlword asks for; the rising edge of bit 7 is judged by whoever keeps the previous word.
enum class ControlCommand : std::uint8_t {
  disable_voltage,
  quick_stop,
  shutdown,
  switch_on,
  enable_operation,
};

/// Decodes bits 0-3 (bit 7 aside). Every pattern means something. real-time safe.
constexpr ControlCommand decode_command(std::uint16_t word) noexcept {
  if (!(word & controlword::kEnableVoltage)) return ControlCommand::disable_voltage;
  if (!(word & controlword::kQuickStop)) return ControlCommand::quick_stop;
  if (!(word & controlword::kSwitchOn)) return ControlCommand::shutdown;
  return word & controlword::kEnableOperation ? ControlCommand::enable_operation : ControlCommand::switch_on;
}

}  // namespace servogate::canopen
