// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware_if/image/can_bus.hpp"

/// A CAN frame as python-can's `udp_multicast` sends it: a MessagePack map with the attributes of
/// can.Message. Source: python-can 4.1, interfaces/udp_multicast/utils.py; MessagePack specification. Both
/// real-time safe.
namespace servogate::usercan {

inline constexpr std::size_t kMaxPacket = 512;

/// Writes the frame; returns the number of bytes.
std::size_t pack(const image::CanFrame& frame, double timestamp_s,
                 std::span<std::uint8_t, kMaxPacket> out) noexcept;
/// Reads a frame; unknown keys are read over. The time stamp is not taken: the receiver's clock is what
/// counts. False: no such frame.
bool unpack(std::span<const std::uint8_t> bytes, image::CanFrame& frame) noexcept;

}  // namespace servogate::usercan
