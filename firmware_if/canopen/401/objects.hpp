// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// Object indices by their names in CiA 401-1. Sub-index n is the n-th group of eight lines, or channel n.
namespace servogate::canopen::io {

inline constexpr std::uint16_t kReadInput8 = 0x6000, kPolarityInput8 = 0x6002, kFilterConstantInput8 = 0x6003,
                               kInterruptEnableDigital = 0x6005, kInterruptAnyChange8 = 0x6006,
                               kInterruptLowToHigh8 = 0x6007, kInterruptHighToLow8 = 0x6008,
                               kWriteOutput8 = 0x6200, kPolarityOutput8 = 0x6202, kErrorModeOutput8 = 0x6206,
                               kErrorValueOutput8 = 0x6207, kFilterMaskOutput8 = 0x6208,
                               kReadAnalogueInput16 = 0x6401, kWriteAnalogueOutput16 = 0x6411,
                               kInterruptTriggerSelection = 0x6421, kInterruptEnableAnalogue = 0x6423,
                               kInterruptUpperLimit = 0x6424, kInterruptLowerLimit = 0x6425,
                               kInterruptDelta = 0x6426, kInterruptNegativeDelta = 0x6427,
                               kInterruptPositiveDelta = 0x6428, kErrorModeAnalogueOutput = 0x6443,
                               kErrorValueAnalogueOutput = 0x6444;

inline constexpr std::uint16_t kDeviceProfile = 401;
/// Bits of 1000h above the profile number.
inline constexpr std::uint32_t kDigitalInputs = 1u << 16, kDigitalOutputs = 1u << 17,
                               kAnalogueInputs = 1u << 18, kAnalogueOutputs = 1u << 19;

/// Bits of 6421h: what of an analogue input is an event.
inline constexpr std::uint8_t kAboveUpper = 1, kBelowLower = 2, kByDelta = 4, kByNegativeDelta = 8,
                              kByPositiveDelta = 16;

}  // namespace servogate::canopen::io
