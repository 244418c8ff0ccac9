// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "firmware_if/canopen/301/nmt.hpp"

/// Not real-time safe.
namespace servogate::canopen {

/// What a device says of itself in 1000h, in both languages (text::both): "servo drive (CiA 402)".
std::string device_type_words(std::uint32_t device_type);
/// "pre-operational", in both languages.
std::string nmt_state_words(NmtState state);
/// The same for JSON: "pre_operational".
const char* nmt_state_name(NmtState state);
/// Modes of 6502h by their short names: "pp pv hm csp".
std::string drive_modes(std::uint32_t supported, const char* between = " ");
/// 1000h says that the device follows this profile.
constexpr bool has_profile(std::uint32_t device_type, std::uint16_t number) {
  return (device_type & 0xFFFF) == number;
}

}  // namespace servogate::canopen
