// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/packets.hpp"

namespace servogate::image {

/// Packets::set_bit() of a place of format BL, for code that writes many which the compiler knows: then it is
/// an instruction or two each. real-time safe.
[[gnu::always_inline]] inline void put_bit(Packets& packets, const Place& bl, bool value) noexcept {
  const std::uint32_t at = bl.index / 8;
  if (at >= packets.size(bl.packet)) return;
  std::uint8_t& byte = packets.data(bl.packet)[at];
  const auto mask = static_cast<std::uint8_t>(1u << bl.index % 8);
  byte = static_cast<std::uint8_t>((byte & ~mask) | (value ? mask : 0));
}

}  // namespace servogate::image
