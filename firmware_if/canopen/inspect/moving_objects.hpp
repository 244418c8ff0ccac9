// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

namespace servogate::canopen {

/// Whether writing this object can move a drive, release its brake or start its program: the set-points,
/// controlword and modes of every axis of CiA 402, its outputs 60FEh, outputs of CiA 401 (6200h to 63FFh,
/// 6410h to 641Fh), and NMT requests 1F82h.
bool can_move(std::uint16_t index);

/// Writing this takes the torque away and brings none: a controlword (6040h of any axis) whose command is
/// Disable voltage or Quick stop (CiA 402-2, device control). It waits for nothing and needs no permission.
bool takes_energy_away(std::uint16_t index, std::uint8_t subindex, std::span<const std::uint8_t> data);

}  // namespace servogate::canopen
