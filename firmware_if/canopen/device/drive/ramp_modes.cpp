// SPDX-License-Identifier: Apache-2.0
// Velocity mode (vl), interpolated position mode (ip) and profile position mode (pp) of ServoProfile.
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
constexpr std::uint16_t kNewSetPoint = controlword::kModeSpecific4,
                        kChangeImmediately = controlword::kModeSpecific5,
                        kRelative = controlword::kModeSpecific6, kChangeOnSetPoint = 1u << 9;
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
    const double d = quick_stop_ramp();
    ramp_to(0.0, d, d);
  } else if (v_.controlword & kRampUnlocked) {
    ramp_to(vl_reference(), acceleration, deceleration);
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
    ramp_to(0.0, d, d);
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

SetPoint ServoProfile::set_point_given() const noexcept {
  const auto word = static_cast<std::uint16_t>(v_.controlword);
  return {v_.target_position,
          (word & kRelative) != 0,
          (word & kChangeOnSetPoint) != 0,
          static_cast<double>(v_.profile_velocity),
          static_cast<double>(v_.end_velocity),
          static_cast<double>(v_.profile_acceleration),
          static_cast<double>(v_.profile_deceleration)};
}

void ServoProfile::forget_set_points() noexcept {
  set_point_active_ = set_point_waiting_ = false;
  passed_ = 0.0;
}

// The handshake of bit 4 and status bit 12: one set-point in work and one waiting. While both places are
// taken the acknowledge stays, and what comes then is not taken.
// Source: CiA 402-2, "Profile position mode", figures of the set-point handshake.
void ServoProfile::take_set_points() noexcept {
  const auto word = static_cast<std::uint16_t>(v_.controlword);
  const bool start = word & kNewSetPoint, immediately = word & kChangeImmediately;
  if (start && !start_bit_ && (!set_point_waiting_ || immediately)) {
    waiting_ = set_point_given();
    set_point_waiting_ = set_point_acknowledged_ = true;
    if (immediately) start_set_point();
  }
  start_bit_ = start;
  if (!set_point_active_ && set_point_waiting_) start_set_point();
  if (!start && !set_point_waiting_) set_point_acknowledged_ = false;
}

double ServoProfile::target_of(const SetPoint& p) noexcept {
  const double from = set_point_active_ ? active_target_ : demand_.position;
  return p.relative ? from + static_cast<double>(p.object) : target_from_object(p.object);
}

void ServoProfile::start_set_point() noexcept {
  active_target_ = target_of(waiting_);
  active_ = waiting_;
  set_point_active_ = true;
  set_point_waiting_ = false;
  passed_ = 0.0;
  window_time_.reset();
}

/// Speed with which the motion under way shall arrive. Before a set-point with bit 9 it does not slow down,
/// but for what the next one needs to end at its own target.
double ServoProfile::arrival_speed(double target) noexcept {
  if (target != active_target_) return 0.0;  // a software limit
  if (!set_point_waiting_ || !waiting_.change_on_target) return active_.end_velocity;
  const bool limited = internal_limit_;
  const double way = limited_target(target_of(waiting_)) - target;
  internal_limit_ = limited;
  const double direction = target - demand_.position;
  if (way * (direction != 0.0 ? direction : demand_.velocity) <= 0.0) return 0.0;
  const double d = deceleration_of(waiting_.deceleration);
  return std::sqrt(waiting_.end_velocity * waiting_.end_velocity + 2.0 * d * std::abs(way));
}

/// Behind a target that was passed with 6082h that speed is kept, up to the software limits, until the next
/// set-point.
void ServoProfile::go_on_behind_target() noexcept {
  if (stopped_by_limit_switch(passed_)) return stop_at_limit_switch();
  constexpr double kFar = 1e12;
  const bool limited = internal_limit_;
  const double end = limited_target(demand_.position + kFar * passed_);
  const double speed = std::min({active_.end_velocity, active_.velocity, profile_speed()});
  const bool there = approach_position(demand_, end, speed, acceleration_of(active_.acceleration),
                                       deceleration_of(active_.deceleration), h_);
  internal_limit_ = limited || there;
}

void ServoProfile::stop_at_limit_switch() noexcept {
  internal_limit_ = true;
  const double d = static_cast<double>(v_.quick_stop_deceleration);
  ramp_to(0.0, d, d);
}

void ServoProfile::position_to_target() noexcept {
  const double target = limited_target(active_target_);
  if (stopped_by_limit_switch(target - demand_.position)) return stop_at_limit_switch();
  if (!approach_position(demand_, target, std::min(active_.velocity, profile_speed()),
                         acceleration_of(active_.acceleration), deceleration_of(active_.deceleration), h_,
                         arrival_speed(target)))
    return;
  if (demand_.velocity != 0.0) passed_ = std::copysign(1.0, demand_.velocity);
  const double off = std::abs(target - static_cast<double>(servo_.position));
  watch_window(off <= static_cast<double>(v_.position_window));
  const bool done = passed_ != 0.0 || waiting_.change_on_target || in_window(v_.position_window_time);
  if (set_point_waiting_ && done) start_set_point();
}

void ServoProfile::profile_position() noexcept {
  if (command_.loop != ServoCommand::Loop::position) {
    const double velocity = servo_.velocity;
    hold_actual();
    demand_.velocity = velocity;
  }
  take_set_points();
  if (!set_point_active_) {
    const double deceleration = static_cast<double>(v_.profile_deceleration);
    ramp_to(0.0, deceleration, deceleration);
  } else if (passed_ != 0.0 && set_point_waiting_) {
    start_set_point();
    position_to_target();
  } else if (passed_ != 0.0) {
    go_on_behind_target();
  } else {
    position_to_target();
  }
  command_position();
}

}  // namespace servogate::canopen
