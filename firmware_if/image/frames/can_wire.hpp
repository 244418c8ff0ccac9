// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::image {

/// Bits after the stuffed part of a frame that reaches the bus: CRC delimiter, acknowledge slot and
/// delimiter, seven bits end of frame. Source: ISO 11898-1, 10.4.2.
inline constexpr std::uint32_t kTrailerBits = 10;
/// Bits of rest between a frame and the next one (intermission). Source: ISO 11898-1, 10.4.6.
inline constexpr std::uint32_t kIntermissionBits = 3;

/// CRC-15 of a classic frame over start of frame, arbitration, control and data field, unstuffed; generator
/// 4599h. Source: ISO 11898-1, 10.4.2.6. real-time safe.
std::uint16_t frame_crc(const CanFrame& frame) noexcept;

/// Number of stuff bits that the very bits of this frame need, its CRC included. real-time safe.
std::uint32_t stuff_bits(const CanFrame& frame) noexcept;

/// Exact length of a classic frame on the wire, from start of frame to the end of the end-of-frame field; the
/// intermission is not included. At most 8 bytes count. real-time safe.
std::uint32_t frame_bits(const CanFrame& frame) noexcept;

/// The same, taken from the frame where somebody has counted already (CanFrame::wire_bits). real-time safe.
inline std::uint32_t known_bits(const CanFrame& frame) noexcept {
  return frame.wire_bits != 0 ? frame.wire_bits : frame_bits(frame);
}

}  // namespace servogate::image
