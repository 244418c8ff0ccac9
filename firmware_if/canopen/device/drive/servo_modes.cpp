// SPDX-License-Identifier: Apache-2.0
// The modes of operation of ServoProfile.
#include <cmath>

#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/canopen/device/drive/servo_profile.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kStart = controlword::kModeSpecific4;

}  // namespace

void ServoProfile::select_mode() noexcept {
  const auto wanted = static_cast<OperationMode>(v_.mode);
  if (wanted == mode_) return;
  // Values that came by PDO are checked here, those by SDO were before.
  if (v_.mode != 0 && !(v_.mode > 0 && (v_.supported_modes & supported_bit(wanted)))) return;
  mode_ = wanted;
  homing_.cancel();
  homing_attained_ = homing_error_ = false;
  forget_set_points();
  set_point_acknowledged_ = false;
  start_bit_ = v_.controlword & kStart;
  window_time_.reset();
  threshold_time_ = 0.0;
  new_target_ = false;
  buffer_.clear();
  if (command_.loop != ServoCommand::Loop::position) {
    const double velocity = servo_.velocity;
    hold_actual();
    demand_.velocity = power_.energised() ? velocity : 0.0;
  }
  cyclic_target_ = demand_.position;
  ticks_left_ = 0;
}

void ServoProfile::run_mode() noexcept {
  switch (mode_) {
    case OperationMode::cyclic_sync_position:
      return cyclic_position();
    case OperationMode::cyclic_sync_velocity:
      return cyclic_velocity();
    case OperationMode::cyclic_sync_torque:
      return cyclic_torque();
    case OperationMode::profile_position:
      return profile_position();
    case OperationMode::profile_velocity:
      return profile_velocity();
    case OperationMode::profile_torque:
      return profile_torque();
    case OperationMode::homing:
      return homing();
    case OperationMode::velocity:
      return velocity_mode();
    case OperationMode::interpolated_position:
      return interpolated_position();
    default:
      // No mode: stay where we are.
      ramp_to(0.0, slow_down(), slow_down());
      return command_position();
  }
}

// The nearest unwrapped position whose low 32 bits are the object's value, so that an axis may turn without
// end.
double ServoProfile::target_from_object(std::int64_t object_value) noexcept {
  const auto here = static_cast<std::int64_t>(std::floor(demand_.position + 0.5)) - origin_;
  const auto difference =
      static_cast<std::int32_t>(static_cast<std::uint32_t>(object_value) - static_cast<std::uint32_t>(here));
  return static_cast<double>(here + difference + origin_);
}

double ServoProfile::within_limits(double target) const noexcept {
  // The whole range of the object, or an empty one, is no limit: the axis may turn without end.
  constexpr std::int64_t kWholeRange = 0xFFFF'FFFF;
  const std::int64_t width = v_.limit_max - v_.limit_min;
  if (width <= 0 || width == kWholeRange) return target;
  const auto low = static_cast<double>(v_.limit_min + origin_),
             high = static_cast<double>(v_.limit_max + origin_);
  return target < low ? low : target > high ? high : target;
}

double ServoProfile::limited_target(double target) noexcept {
  const double limited = within_limits(target);
  internal_limit_ = internal_limit_ || limited != target;
  return limited;
}

// What cyclic_position() would make of it: a segment from where the axis rests to the same place.
void ServoProfile::drop_target_that_is_met() noexcept {
  if (!new_target_ || mode_ != OperationMode::cyclic_sync_position || !power_.following() || halted()) return;
  if (ticks_left_ != 0 || demand_.velocity != 0.0 || demand_.acceleration != 0.0 ||
      previous_segment_velocity_ != 0.0)
    return;
  const double target = target_from_object(v_.target_position + v_.position_offset);
  if (target == cyclic_target_ && target == demand_.position && target == within_limits(target))
    new_target_ = false;
}

void ServoProfile::plan_cyclic_segment(double target) noexcept {
  segment_target_ = target;
  ticks_left_ = segment_ticks_;
  const double velocity = (target - demand_.position) / (segment_ticks_ * h_);
  demand_.acceleration = (velocity - previous_segment_velocity_) / (segment_ticks_ * h_);
  demand_.velocity = previous_segment_velocity_ = velocity;
}

// Straight from the present demand to the target within one interpolation period 60C2h.
void ServoProfile::cyclic_position() noexcept {
  if (new_target_) cyclic_target_ = target_from_object(v_.target_position + v_.position_offset);
  const double target = limited_target(cyclic_target_);
  if (stopped_by_limit_switch(target - demand_.position)) {
    const double d = static_cast<double>(v_.quick_stop_deceleration);
    ramp_to(0.0, d, d);
    ticks_left_ = 0;
    previous_segment_velocity_ = 0.0;
    internal_limit_ = true;
  } else {
    if (new_target_) plan_cyclic_segment(target);
    if (ticks_left_ > 0) {
      demand_.position += (segment_target_ - demand_.position) / ticks_left_;
      --ticks_left_;
    } else {
      demand_.velocity = demand_.acceleration = 0.0;
      previous_segment_velocity_ = 0.0;
    }
  }
  new_target_ = false;
  command_position();
  command_.velocity += static_cast<double>(v_.velocity_offset);
  command_.torque = static_cast<double>(v_.torque_offset);
}

void ServoProfile::cyclic_velocity() noexcept {
  const double most = max_speed();
  double velocity = static_cast<double>(v_.target_velocity + v_.velocity_offset);
  if (std::abs(velocity) > most || stopped_by_limit_switch(velocity)) {
    internal_limit_ = true;
    velocity =
        std::abs(velocity) > most && !stopped_by_limit_switch(velocity) ? std::copysign(most, velocity) : 0.0;
  }
  command_.loop = ServoCommand::Loop::velocity;
  command_.velocity = velocity;
  command_.acceleration = 0.0;
  command_.torque = static_cast<double>(v_.torque_offset);
}

void ServoProfile::cyclic_torque() noexcept {
  double torque = static_cast<double>(v_.target_torque + v_.torque_offset);
  if (stopped_by_limit_switch(torque)) {
    internal_limit_ = true;
    torque = 0.0;
  }
  command_.loop = ServoCommand::Loop::torque;
  command_.torque = torque;
}

void ServoProfile::profile_torque() noexcept {
  if (command_.loop != ServoCommand::Loop::torque) torque_demand_ = servo_.torque;
  const double step = static_cast<double>(v_.torque_slope) * h_;
  torque_demand_ += std::clamp(static_cast<double>(v_.target_torque) - torque_demand_, -step, step);
  command_.loop = ServoCommand::Loop::torque;
  command_.torque = torque_demand_;
}

double ServoProfile::profile_speed() const noexcept {
  return std::min(static_cast<double>(v_.max_profile_velocity), max_speed());
}

// 60C5h and 60C6h bound what any object asks for. A data sheet may leave them at 0: no limit.
double ServoProfile::acceleration_of(double asked) const noexcept {
  return v_.max_acceleration > 0 ? std::min(asked, static_cast<double>(v_.max_acceleration)) : asked;
}
double ServoProfile::deceleration_of(double asked) const noexcept {
  return v_.max_deceleration > 0 ? std::min(asked, static_cast<double>(v_.max_deceleration)) : asked;
}
void ServoProfile::ramp_to(double velocity, double acceleration, double deceleration) noexcept {
  ramp_velocity(demand_, velocity, acceleration_of(acceleration), deceleration_of(deceleration), h_);
}

void ServoProfile::profile_velocity() noexcept {
  if (command_.loop == ServoCommand::Loop::position && power_.following() && demand_.velocity == 0.0)
    demand_.velocity = servo_.velocity;
  const double most = profile_speed();
  double target = static_cast<double>(v_.target_velocity);
  if (std::abs(target) > most) {
    target = std::copysign(most, target);
    internal_limit_ = true;
  }
  if (stopped_by_limit_switch(target)) {
    target = 0.0;
    internal_limit_ = true;
  }
  ramp_to(target, static_cast<double>(v_.profile_acceleration), static_cast<double>(v_.profile_deceleration));
  command_.loop = ServoCommand::Loop::velocity;
  command_.velocity = demand_.velocity;
  command_.acceleration = demand_.acceleration;
  command_.torque = 0.0;
  const double off = std::abs(static_cast<double>(v_.target_velocity) - servo_.velocity);
  watch_window(off <= static_cast<double>(v_.velocity_window));
}

// Halt interrupts a homing. It goes on afterwards unless bit 4 was taken away meanwhile; an edge of bit 4
// acts then. Source: CiA 402-2, controlword of the homing mode: bit 4 "start or continue".
void ServoProfile::halt_homing() noexcept {
  if (mode_ != OperationMode::homing || (v_.controlword & kStart)) return;
  homing_.cancel();
  start_bit_ = false;
}

void ServoProfile::homing() noexcept {
  const bool start = v_.controlword & kStart;
  if (start && !start_bit_) {
    homing_attained_ = homing_error_ = false;
    const bool here = v_.homing_method == settings_.quirks.homing_method_here;
    homing_error_ = !homing_.start(here ? 37 : static_cast<int>(v_.homing_method), inputs_, servo_);
  }
  if (!start) homing_.cancel();
  start_bit_ = start;
  const bool resting = demand_.velocity == 0.0 && standstill();
  const double speed = homing_.tick(inputs_, servo_, static_cast<double>(v_.homing_speed_switch),
                                    static_cast<double>(v_.homing_speed_zero), resting);
  const auto acceleration = static_cast<double>(v_.homing_acceleration);
  ramp_to(speed, acceleration, acceleration);
  if (homing_.state() == HomingSequence::State::done) finish_homing();
  if (homing_.state() == HomingSequence::State::failed) homing_error_ = true;
  command_position();
}

// Zero position = home position + home offset (607Ch), so that home itself is at minus the offset.
void ServoProfile::finish_homing() noexcept {
  origin_ = homing_.home() + v_.home_offset;
  homing_.cancel();
  homing_attained_ = true;
}

std::uint16_t ServoProfile::mode_bits() const noexcept {
  using namespace statusword;
  const bool rests = demand_.velocity == 0.0 && standstill();
  std::uint16_t word = 0;
  if (halted() && rests && mode_ != OperationMode::none) word |= kTargetReached;
  switch (mode_) {
    case OperationMode::profile_position:
      if (set_point_acknowledged_) word |= kModeSpecific12;
      if (following_exceeded_) word |= kModeSpecific13;
      if (!set_point_active_ || passed_ != 0.0 || in_window(v_.position_window_time)) word |= kTargetReached;
      return word;
    case OperationMode::profile_velocity:
      if (!halted() && in_window(v_.velocity_window_time)) word |= kTargetReached;
      // Speed is not zero any more once it has been above 606Fh for longer than 6070h.
      if (threshold_time_ * 1e3 <= static_cast<double>(v_.velocity_threshold_time)) word |= kModeSpecific12;
      return word;
    case OperationMode::homing:
      if (homing_attained_) word |= kModeSpecific12;
      if (homing_error_) word |= kModeSpecific13;
      if (homing_.state() != HomingSequence::State::running && rests) word |= kTargetReached;
      return word;
    case OperationMode::interpolated_position:
      if (interpolating()) word |= kModeSpecific12;
      if (!halted() && rests && buffer_.count() == 0) word |= kTargetReached;
      return word;
    case OperationMode::cyclic_sync_position:
      if (following_exceeded_) word |= kModeSpecific13;
      [[fallthrough]];
    case OperationMode::cyclic_sync_velocity:
    case OperationMode::cyclic_sync_torque:
      if (power_.following() && !halted() && !internal_limit_) word |= kModeSpecific12;
      return word;
    default:
      return word;
  }
}

}  // namespace servogate::canopen
