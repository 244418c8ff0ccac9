// SPDX-License-Identifier: Apache-2.0
// Velocity mode (vl) and interpolated position mode (ip) of ServoProfile.
#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/canopen/device/drive/servo_profile.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kRampEnabled = controlword::kModeSpecific4,
                        kRampUnlocked = controlword::kModeSpecific5,
                        kReferenceUsed = controlword::kModeSpecific6;
constexpr std::uint16_t kInterpolate = controlword::kModeSpecific4;
// A ramp of no time: as fast as a number can say.
constexpr double kAtOnce = 1e15;

}  // namespace

/// Counts/s of one unit of 6042h: rpm times set-point factor 604Bh times dimension factor 604Ch.
double ServoProfile::vl_unit() const noexcept {
  const double factor =
      static_cast<double>(v_.vl_setpoint_numerator) / static_cast<double>(v_.vl_setpoint_denominator) *
      static_cast<double>(v_.vl_dimension_numerator) / static_cast<double>(v_.vl_dimension_denominator);
  return factor * static_cast<double>(settings_.counts_per_rev) / 60.0;
}

double ServoProfile::vl_ramp(std::int64_t delta_speed, std::int64_t delta_time) const noexcept {
  if (delta_time == 0) return kAtOnce;
  return static_cast<double>(delta_speed) / static_cast<double>(delta_time) * std::abs(vl_unit());
}

/// Input of the ramp: the target within 6046h, or nothing while bit 6 does not use it.
double ServoProfile::vl_reference() noexcept {
  if (!(v_.controlword & kReferenceUsed)) return 0.0;
  double speed = static_cast<double>(v_.vl_target) * vl_unit();
  const double unit = std::abs(vl_unit());
  const double least = static_cast<double>(v_.vl_min) * unit,
               most = std::min(static_cast<double>(v_.vl_max) * unit, max_speed());
  if (std::abs(speed) > most) {
    speed = std::copysign(most, speed);
    internal_limit_ = true;
  } else if (speed != 0.0 && std::abs(speed) < least) {
    speed = std::copysign(least, speed);
    internal_limit_ = true;
  }
  if (!stopped_by_limit_switch(speed)) return speed;
  internal_limit_ = true;
  return 0.0;
}

// Source: CiA 402-2, "Velocity mode": bit 4 lets the ramp generator drive the motor (otherwise it stands),
// bit 5 lets the ramp go on (otherwise its output is held), bit 6 gives it the reference (otherwise zero).
void ServoProfile::velocity_mode() noexcept {
  const double acceleration = vl_ramp(v_.vl_acceleration_speed, v_.vl_acceleration_time);
  const double deceleration = vl_ramp(v_.vl_deceleration_speed, v_.vl_deceleration_time);
  if (!(v_.controlword & kRampEnabled)) {
    const double d = static_cast<double>(v_.quick_stop_deceleration);
    ramp_velocity(demand_, 0.0, d, d, h_);
  } else if (v_.controlword & kRampUnlocked) {
    ramp_velocity(demand_, vl_reference(), acceleration, deceleration, h_);
  } else {
    demand_.acceleration = 0.0;
    demand_.position += demand_.velocity * h_;
  }
  command_.loop = ServoCommand::Loop::velocity;
  command_.velocity = demand_.velocity;
  command_.acceleration = demand_.acceleration;
  command_.torque = 0.0;
}

bool ServoProfile::interpolating() const noexcept {
  return (v_.controlword & kInterpolate) && power_.following() && !halted();
}

// One record a period 60C2h, straight from one to the next; without a record the axis waits where it is.
// Source: CiA 402-2, "Interpolated position mode", linear interpolation (60C0h = 0).
void ServoProfile::interpolated_position() noexcept {
  if (!interpolating()) {
    const double d = static_cast<double>(v_.profile_deceleration);
    ramp_velocity(demand_, 0.0, d, d, h_);
    ticks_left_ = 0;
    previous_segment_velocity_ = 0.0;
    return command_position();
  }
  if (ticks_left_ == 0 && buffer_.count() > 0)
    plan_cyclic_segment(limited_target(target_from_object(buffer_.pop())));
  if (stopped_by_limit_switch(segment_target_ - demand_.position) && ticks_left_ > 0) {
    internal_limit_ = true;
    ticks_left_ = 0;
  }
  if (ticks_left_ > 0) {
    demand_.position += (segment_target_ - demand_.position) / ticks_left_;
    --ticks_left_;
  } else {
    demand_.velocity = demand_.acceleration = 0.0;
    previous_segment_velocity_ = 0.0;
  }
  command_position();
}

/// 60C4h was written.
void ServoProfile::buffer_configured(std::uint8_t subindex) noexcept {
  if (subindex == 2 || subindex == 3)
    buffer_.configure(static_cast<std::uint32_t>(v_.ip_buffer_size),
                      static_cast<InterpolationBuffer::Organisation>(v_.ip_buffer_organisation));
  if (subindex == 6) buffer_.open(v_.ip_buffer_clear != 0);
}

}  // namespace servogate::canopen
