// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/standstill.hpp"

#include "firmware_if/image/interface_map.hpp"

namespace servogate::gateway {

using image::DriveState;

namespace {

bool has_torque(const image::DriveFeedback& drive) noexcept {
  return drive.online &&
         (drive.state == DriveState::operation_enabled || drive.state == DriveState::quick_stop_active ||
          drive.state == DriveState::fault_reaction_active);
}

}  // namespace

bool nothing_moves(const image::ProcessImage& image) noexcept {
  for (int n = 0; n < image.axis_count; ++n)
    if (image.axes[static_cast<std::size_t>(n)].moving) return false;
  for (int s = 0; s < image.spindle_count; ++s)
    if (image.spindles[static_cast<std::size_t>(s)].running) return false;
  return !image.homing;
}

bool axes_off(const image::ProcessImage& image) noexcept {
  for (int n = 0; n < image.axis_count; ++n) {
    // `enabled` falls as soon as the brake begins to close, the torque behind it.
    const image::AxisImage& a = image.axes[static_cast<std::size_t>(n)];
    if (a.enabled || a.moving || has_torque(a.drive)) return false;
  }
  return true;
}

bool spindle_rests(const image::ProcessImage& image, int spindle) noexcept {
  constexpr image::Place kZeroSpeed = image::field(image::kSpindleFields, "zero_speed");
  const image::DriveFeedback& drive = image.spindles[static_cast<std::size_t>(spindle)].drive;
  return !has_torque(drive) && image.packets.bit(image::at(kZeroSpeed, image::spindle_base(spindle)));
}

bool spindle_lost(const image::ProcessImage& image, const machine::MachineConfig& machine,
                  int spindle) noexcept {
  const auto n = static_cast<std::size_t>(spindle);
  const machine::SpindleConfig& s = machine.spindles[n];
  return (!s.drive.empty() || !s.inverter.empty()) && !image.spindles[n].drive.online;
}

bool spindles_answer(const image::ProcessImage& image, const machine::MachineConfig& machine) noexcept {
  for (int s = 0; s < image.spindle_count; ++s) {
    const bool heard = image.spindles[static_cast<std::size_t>(s)].drive.statusword != 0;
    if (heard && spindle_lost(image, machine, s)) return false;
  }
  return true;
}

bool spindles_rest(const image::ProcessImage& image) noexcept {
  for (int s = 0; s < image.spindle_count; ++s)
    if (!spindle_rests(image, s)) return false;
  return true;
}

}  // namespace servogate::gateway
