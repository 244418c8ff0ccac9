// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "kernel/axis/axis.hpp"

namespace servogate::axis {

using image::AxisOwner;

bool Axis::acquire(AxisOwner owner) noexcept {
  if (owner_ != owner && (moving_ || own_motion_ || geared())) return false;
  owner_ = owner;
  release_pending_ = false;
  return true;
}

bool Axis::release(AxisOwner owner) noexcept {
  if (owner_ != owner) return false;
  release_pending_ = moving_ || own_motion_;
  if (!release_pending_) owner_ = AxisOwner::none;
  return !release_pending_;
}

MotionLimits Axis::limits_with(double velocity) const noexcept {
  MotionLimits lim = config_.limits;
  lim.velocity = std::min(lim.velocity, velocity);
  return lim;
}

double Axis::jog_speed() const noexcept {
  const bool slow = !homed_ || limit_plus_ || limit_minus_;
  return slow ? std::min(config_.slow_velocity, config_.jog_velocity) : config_.jog_velocity;
}

/// Inside the travel; an axis that stands outside may come back but not go further out.
double Axis::clipped(double target) const noexcept {
  if (!homed_ || !config_.travel_limited) return target;
  return std::clamp(target, std::min(config_.travel_min, set_.x), std::max(config_.travel_max, set_.x));
}

bool Axis::into_limit(double direction) const noexcept {
  return direction > 0 ? limit_plus_ : direction < 0 && limit_minus_;
}

/// The axis begins a motion of its own for `owner`.
bool Axis::begin_own(AxisOwner owner) noexcept {
  if (!motion_permitted() || !feed_enable_ || homing_.active() || !acquire(owner)) return false;
  if (!own_motion_) ramp_.reset(set_, config_.limits);
  own_motion_ = true;
  moving_ = true;
  return true;
}

bool Axis::jog_increment(double distance) noexcept {
  if (!std::isfinite(distance) || into_limit(distance)) return false;
  const double from = own_motion_ && manual_ == Manual::increment ? ramp_.target() : set_.x;
  const double target = clipped(from + distance);
  if (target == set_.x && !own_motion_) return false;
  if (!begin_own(AxisOwner::manual)) return false;
  manual_ = Manual::increment;
  jog_end_ = image::JogEnd::none;
  ramp_.move_to(target, limits_with(jog_speed()));
  return true;
}

bool Axis::jog_continuous(int direction, image::Nanoseconds now) noexcept {
  if (direction == 0 || into_limit(direction)) return false;
  if (clipped(set_.x + direction) == set_.x) return false;
  if (own_motion_ && manual_ == Manual::continuous && direction != jog_direction_) jog_stop();
  if (own_motion_ && manual_ != Manual::continuous) return false;
  if (!begin_own(AxisOwner::manual)) return false;
  manual_ = Manual::continuous;
  jog_end_ = image::JogEnd::none;
  jog_direction_ = direction > 0 ? 1 : -1;
  keep_alive_ns_ = now;
  return true;
}

void Axis::jog_stop(image::JogEnd why) noexcept {
  if (owner_ != AxisOwner::manual || manual_ == Manual::rest) return;
  end_jog(why);
  manual_ = Manual::rest;
  ramp_.stop(config_.limits);
}

bool Axis::move_to(double position, double velocity) noexcept {
  const bool free = owner_ != AxisOwner::process && owner_ != AxisOwner::homing;
  if (!free || !(velocity > 0.0) || !std::isfinite(position) || clipped(position) != position) return false;
  if (!homed_ || into_limit(position - set_.x)) return false;
  if (!begin_own(owner_ == AxisOwner::none ? AxisOwner::manual : owner_)) return false;
  manual_ = Manual::position;
  ramp_.move_to(position, limits_with(velocity));
  return true;
}

/// A motion under way was laid to end inside the travel with the acceleration it has: less would pass by.
bool Axis::begin_plc(double goal, MotionLimits limits, bool endless) noexcept {
  const bool under_way = own_motion_ && manual_ == Manual::plc;
  if (own_motion_ && owner_ == AxisOwner::plc && !under_way && moving_)
    limits.acceleration = config_.limits.acceleration;  // it is being stopped
  if (!begin_own(AxisOwner::plc)) return false;
  torque_.leave();
  if (under_way) limits.acceleration = std::max(limits.acceleration, goal_limits_.acceleration);
  manual_ = Manual::plc;
  goal_ = goal;
  goal_endless_ = endless;
  goal_limits_ = limits;
  advance_plc();
  return true;
}

bool Axis::plc_move_to(double position, MotionLimits limits) noexcept {
  if (!std::isfinite(position) || clipped(position) != position || into_limit(position - set_.x))
    return false;
  return begin_plc(position, limits, false);
}

bool Axis::plc_move_at(int direction, MotionLimits limits) noexcept {
  if (direction == 0 || into_limit(direction)) return false;
  if (!homed_ || !config_.travel_limited) return begin_plc(direction * limits.velocity, limits, true);
  return begin_plc(
      direction > 0 ? std::max(config_.travel_max, set_.x) : std::min(config_.travel_min, set_.x), limits,
      false);
}

bool Axis::plc_torque(double torque, double ramp, double velocity_limit) noexcept {
  const bool possible = config_.torque.max > 0.0 && std::isfinite(torque) && velocity_limit > 0.0;
  if (!possible || into_limit(torque) || !begin_own(AxisOwner::plc)) return false;
  manual_ = Manual::torque;
  torque_.begin(torque, ramp, std::min(velocity_limit, config_.limits.velocity));
  return true;
}

bool Axis::torque_reached() const noexcept {
  constexpr double kWindow = 2.0, kShare = 0.05;  // per cent of the rated torque, share of the wanted one
  if (!torque_.arrived()) return false;
  const double off = std::abs(torque_percent() - torque_.wanted());
  return !drive_.torque_known || off <= std::max(kWindow, kShare * std::abs(torque_.wanted()));
}

HomingInputs Axis::homing_inputs(double dt) const noexcept {
  HomingInputs in;
  in.dt = dt;
  in.now_ns = now_ns_;
  in.home_switch = home_switch_;
  in.limit_plus = limit_plus_;
  in.limit_minus = limit_minus_;
  in.settled = in_position_ && rest_s_ >= (config_.feedback_delay + 1) * dt;
  in.referenced = homed_;
  in.counts = drive_.position_counts;
  in.latch_counts = drive_.latch_counts;
  in.latch_sequence = drive_.latch_sequence;
  in.drive = {dt, drive_.mode, drive_.homing, actual_standing_,
              !actual_standing_ && into_limit(actual_velocity_)};
  in.home_counts = drive_.home_counts;
  return in;
}

bool Axis::home() noexcept {
  if (!motion_permitted() || !feed_enable_ || homing_.active() || !standstill()) return false;
  if (!acquire(AxisOwner::homing)) return false;
  drop_reference();
  ramp_.reset(set_, config_.limits);
  homing_.start(ramp_, homing_inputs(0.0));
  own_motion_ = true;
  moving_ = homing_.active();
  homing_reported_ = false;
  return true;
}

/// It may be a program's that rests meanwhile; the program then does without it.
bool Axis::engage() noexcept {
  const bool free = owner_ == AxisOwner::none || owner_ == AxisOwner::process ||
                    (config_.auxiliary && owner_ == AxisOwner::plc);
  if (!free || !motion_permitted() || !feed_enable_ || homing_.active() || own_motion_ || moving_)
    return false;
  owner_ = AxisOwner::gear;
  release_pending_ = false;
  geared_ = set_;
  return true;
}

void Axis::stop() noexcept {
  if (follows()) {
    ramp_.reset(set_, config_.limits);
    manual_ = Manual::rest;
    own_motion_ = true;
    return;
  }
  if (!own_motion_) return;
  if (homing_.active()) homing_.abort(ramp_);
  torque_.end();
  end_jog(image::JogEnd::asked);
  manual_ = Manual::rest;
  ramp_.stop(config_.limits);
}

void Axis::reset() noexcept {
  raised_count_ = 0;
  brake_marked_ = false;
  reset_pending_ = drive_.state == image::DriveState::fault;
  reset_left_s_ = 1.0;
}

void Axis::arm_probe(image::LatchSource source, bool negative_edge) noexcept {
  probe_source_ = source;
  probe_negative_ = negative_edge;
  probe_sequence_ = drive_.latch_sequence;
  probe_armed_ = true;
}

double Axis::probe_position() const noexcept {
  return scale_.position(drive_.latch_counts) - sent(config_.feedback_delay).compensation;
}

void Axis::set_reference(std::int64_t reference_counts) noexcept {
  if (power_.holding()) return;
  scale_.reference_counts = reference_counts;
  scale_.reference_position = config_.homing.position;
  homed_ = true;
  motor_ = scale_.position(drive_.position_counts);
  follow_feedback();
}

void Axis::sleep(double place) noexcept {
  if (power_.holding()) return;
  owner_ = AxisOwner::none;
  asleep_ = homed_ = in_position_ = actual_standing_ = true;
  held_ = moving_ = own_motion_ = stopped_by_reaction_ = process_given_ = off_path_ = false;
  actual_ = set_.x = place;
  set_.v = set_.a = following_error_ = actual_velocity_ = 0.0;
}

/// How fast the spindle has turned is nothing of the axis.
void Axis::wake(std::int64_t reference_counts) noexcept {
  if (!asleep_) return;
  asleep_ = lets_go_ = seen_counts_ = false;
  seen_online_ = drive_.online;
  last_counts_ = drive_.position_counts;
  set_reference(reference_counts);
}

}  // namespace servogate::axis
