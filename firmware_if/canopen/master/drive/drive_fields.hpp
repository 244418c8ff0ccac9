// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/402/drive_profile.hpp"

namespace servogate::canopen {

/// The master of a drive gives this object in RPDOs a value in every cycle. One that it does not, and that
/// the profile's settings do not have either, would be sent as 0. real-time safe.
bool written_in_cycle(const DriveProfile& profile, std::uint16_t index, std::uint8_t subindex) noexcept;
/// The master of a drive takes this object out of TPDOs. real-time safe.
bool read_in_cycle(std::uint16_t index, std::uint8_t subindex) noexcept;

}  // namespace servogate::canopen
