// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// Object indices by their names in CiA 406.
namespace servogate::canopen::encoder {

inline constexpr std::uint16_t kOperatingParameters = 0x6000, kUnitsPerRevolution = 0x6001,
                               kTotalRange = 0x6002, kPresetValue = 0x6003, kPositionValue = 0x6004,
                               kSpeedValue = 0x6030, kCyclicTimer = 0x6200, kOperatingStatus = 0x6500,
                               kSingleTurnResolution = 0x6501, kRevolutions = 0x6502, kAlarms = 0x6503,
                               kSupportedAlarms = 0x6504, kWarnings = 0x6505, kSupportedWarnings = 0x6506;

inline constexpr std::uint16_t kDeviceProfile = 406;
/// High word of 1000h: an absolute rotary encoder of many turns.
inline constexpr std::uint32_t kMultiTurnAbsolute = 2u << 16;

/// Bits of 6000h.
inline constexpr std::uint16_t kClockwiseFalls = 1, kScaling = 4;
/// Bits of 6503h.
inline constexpr std::uint16_t kPositionError = 1;

}  // namespace servogate::canopen::encoder
