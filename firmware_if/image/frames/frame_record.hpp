// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/detail.hpp"

namespace servogate::image {

/// A classic frame as the detail of a notice. A `length` of 0 may mean that only the identifier is known.
struct FrameDetail {
  static constexpr DetailKind kDetail = DetailKind::can_frame;
  std::uint32_t id = 0;
  std::uint8_t length = 0, remote = 0, extended = 0, reserved = 0;
  std::array<std::uint8_t, 8> data{};
};

/// At most 8 bytes. real-time safe.
FrameDetail frame_detail(const CanFrame& frame) noexcept;
/// And back, whatever a file made of it. real-time safe.
CanFrame frame_of(const FrameDetail& detail) noexcept;

}  // namespace servogate::image
