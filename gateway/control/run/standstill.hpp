// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/process_image.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// How long a control waits before it ends: a run in machine time, a resident control by the wall clock. A
/// spindle ramps down under power for as long as its own acceleration takes.
inline constexpr double kAxesOffPatience_s = 5.0;
inline constexpr double kSpindlePatience_s = 60.0;

/// No axis moves or is homed, no spindle is ordered to turn or still turns. Real-time safe.
bool nothing_moves(const image::ProcessImage& image) noexcept;

/// No axis stands under power or moves. Real-time safe.
bool axes_off(const image::ProcessImage& image) noexcept;

/// The spindle stands (its `zero_speed` place) and its drive, where it answers, has no torque. Of an inverter
/// without feedback standstill is what its ramp says. Real-time safe.
bool spindle_rests(const image::ProcessImage& image, int spindle) noexcept;
bool spindles_rest(const image::ProcessImage& image) noexcept;

/// The spindle has a drive, and that answers no more: whether it stands cannot be seen. Real-time safe.
bool spindle_lost(const image::ProcessImage& image, const machine::MachineConfig& machine,
                  int spindle) noexcept;
/// No spindle was lost. A drive that has never answered was never told to turn it. Real-time safe.
bool spindles_answer(const image::ProcessImage& image, const machine::MachineConfig& machine) noexcept;

}  // namespace servogate::gateway
