// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <linux/can.h>

#include <cstddef>

#include "firmware_if/image/can_bus.hpp"

/// Frames as the kernel's raw CAN socket has them. Source: linux/can.h, linux/can/error.h.
namespace servogate::socketcan {

/// Fills the kernel's frame; returns how many bytes of it are to be written (CAN_MTU or CANFD_MTU).
/// real-time safe.
std::size_t to_kernel(const image::CanFrame& frame, canfd_frame& out) noexcept;
/// Takes a frame of `size` bytes apart. False: no frame has this size. real-time safe.
bool from_kernel(const canfd_frame& in, std::size_t size, image::CanFrame& frame) noexcept;
/// The state that an error frame tells of; `before` when it tells of none. real-time safe.
image::CanState state_after(const image::CanFrame& error, image::CanState before) noexcept;

}  // namespace servogate::socketcan
