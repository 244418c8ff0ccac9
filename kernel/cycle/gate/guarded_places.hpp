// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "firmware_if/image/packets.hpp"
#include "kernel/axis/axis.hpp"
#include "kernel/axis/spindle.hpp"

namespace servogate::cycle {

/// Whose places they are.
struct GuardedMachine {
  int processes = 0;
  std::span<const axis::Axis> axes;
  std::span<const axis::Spindle> spindles;
};

/// Whether this place guards motion or energy: the rows of the interface that are marked so
/// (image::InterfaceField::guards) of every process, axis and spindle of the machine, the axes' limit and home
/// switches, the outputs of brakes and inverters. Forced, it says nothing of the machine any more, so it is
/// forced, changed and released at standstill only, and a warning lasts as long as the force. real-time safe.
bool guards_motion(const image::Place& place, const GuardedMachine& machine) noexcept;

}  // namespace servogate::cycle
