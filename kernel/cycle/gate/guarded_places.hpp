// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "firmware_if/image/packets.hpp"
#include "kernel/axis/axis.hpp"

namespace servogate::cycle {

/// Whether this place guards motion or the holding of an axis: limit and home switches, what the axes say of
/// them and of their reference, their enables, the permission of power, outputs of brakes. Forced, it says
/// nothing of the machine any more. real-time safe.
bool guards_motion(const image::Place& place, std::span<const axis::Axis> axes) noexcept;

/// Forced to `value` it only takes a permission away, which may happen at any time. real-time safe.
bool withdraws(const image::Place& place, double value, std::span<const axis::Axis> axes) noexcept;

}  // namespace servogate::cycle
