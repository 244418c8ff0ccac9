// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/axis.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/put_bit.hpp"

namespace servogate::axis {

using image::AxisOwner;
using image::Reaction;

void Axis::configure(const AxisConfig& config, int index) {
  *this = Axis{};
  config_ = config;
  index_ = index;
  assigned_ = config.process;
  scale_ = {config.counts_numerator, config.counts_denominator, config.count_direction, 0, 0.0};
  compensation_.configure(config);
  power_.configure(config.brake);
  homing_.configure(config.homing, config.limits);
  torque_.configure(config.torque);
  if (config.homing.method == HomingMethod::none) set_reference(config.reference_counts);
}

void Axis::read(image::ProcessImage& image) noexcept {
  events_.clear();
  image::AxisImage& shared = image.axes[static_cast<std::size_t>(index_)];
  read_places(image);
  if (asleep_) {
    drive_ = shared.drive;
  } else {
    read_feedback(shared.drive, image.now.period_s());
    read_edges(image);
    supervise_drive();
    supervise_position();
    supervise_switches();
  }
  shared.actual = actual_;
  shared.following_error = following_error_;
  shared.limit_plus = limit_plus_;
  shared.limit_minus = limit_minus_;
  shared.home_switch = home_switch_;
  shared.homed = homed_;
}

void Axis::set_process(const Setpoint& setpoint) noexcept {
  process_ = setpoint;
  process_given_ = true;
}

void Axis::command(image::ProcessImage& image) noexcept {
  const double dt = image.now.period_s();
  if (reaction_ >= Reaction::stop_and_power_off) power_requested_ = false;
  if (asleep_) return write_image(image, {});
  if (!process_given_) process_.bound = false;
  PowerSequence::Outputs power;
  step_power(dt, power);
  if (!power_.holding() || !held_) follow_feedback();
  if (power_.holding()) advance(dt, image.now.t_ns);
  held_ = power_.holding();
  supervise_path_end(dt);
  process_given_ = false;
  if (release_pending_ && !moving_ && !own_motion_) {
    release_pending_ = false;
    owner_ = AxisOwner::none;
  }
  supervise_setpoint();
  supervise_brake();
  if (held_) {
    const double compensation = compensation_.step(set_.x, dt);
    compensation_value_ = homed_ ? compensation : 0.0;
    head_ = (head_ + 1) % kHistory;
    history_[static_cast<std::size_t>(head_)] = {set_.x, compensation_value_};
  }
  update_in_position(dt);
  write_drive(image, power);
  write_image(image, power);
}

void Axis::step_power(double dt, PowerSequence::Outputs& out) noexcept {
  const PowerSequence::State before = power_.state();
  // Where a reaction takes the power anyway (emergency stop), the enable that goes with it says nothing new.
  if (power_requested_ && !power_permitted_ && moving_) raise(alarm::kEnableWithdrawn, 0.0, set_.v);
  PowerSequence::Inputs in;
  in.wanted = power_requested_ && power_permitted_ && !lets_go_;
  // Beside a tap that goes with its spindle the other axes of its process are held, too.
  in.at_rest = held_ ? !moving_ && !process_.bound : actual_standing_;
  in.standing = actual_standing_;
  in.feedback_s = config_.feedback_delay * dt;
  in.drive = drive_.online ? drive_.state : image::DriveState::offline;
  in.reaction = reaction_;
  in.dt = dt;
  out = power_.step(in);
  supervise_power(before);
}

/// The set-point of this cycle, by the owner or, where the motion was taken from it, by the axis itself.
void Axis::advance(double dt, image::Nanoseconds now) noexcept {
  const bool by_itself = owner_ != AxisOwner::process;
  // A process whose axes are to lose their power brakes along the path, and they with it.
  const bool with_the_path = !by_itself && process_given_ && letting_go() && held_;
  const bool stops =
      reaction_ >= Reaction::stop_axes && !(reaction_ <= Reaction::stop_and_power_off && goes_with_master());
  // One that follows a master is no more of a path than a spindle: it stays in step while programs stop.
  const bool stop_now = stops || (!power_.motion_permitted() && !with_the_path) ||
                        (by_itself && !geared() && reaction_ >= Reaction::stop_on_path);
  if (stop_now && !stopped_by_reaction_)
    take_away(reaction_ >= Reaction::stop_on_path ? image::JogEnd::alarm : image::JogEnd::power);
  const double before = set_.x;
  if (own_motion_)
    advance_own(dt, now);
  else if (geared())
    advance_geared(dt);
  else if (!by_itself && !stopped_by_reaction_)
    advance_process(dt);
  moving_ = set_.v != 0.0 || set_.a != 0.0 || set_.x != before || (own_motion_ && !ramp_.done()) ||
            homing_.active() || homing_.drive_leads() || torque_.leads();
  // Whoever left the path comes back to it with the next start only, never while the process still brakes on
  // it.
  const bool path_ended = !process_given_;
  if (stopped_by_reaction_ && !stop_now && path_ended && !moving_ && rest_s_ > 0.01)
    stopped_by_reaction_ = false;
}

/// One that is itself at fault, or does not follow, does not.
bool Axis::goes_with_master() const noexcept {
  return owner_ == AxisOwner::process && process_.bound && held_ && !stopped_by_reaction_ &&
         std::abs(following_error_) <= following_limit_;
}

void Axis::advance_process(double dt) noexcept {
  if (!process_given_) {
    if (set_.v == 0.0 && set_.a == 0.0) return;
    take_away();  // the path ended in motion: stop at the axis' own limits
    advance_own(dt, 0);
    return;
  }
  const double permitted = config_.limits.velocity * dt * 1.05 + 1e-6;
  const double jump = process_.position - set_.x;
  if (std::abs(jump) > permitted) {
    raise(alarm::kSetpointStep, permitted, jump);
    take_away();
    advance_own(dt, 0);
    return;
  }
  const MotionState next{process_.position, process_.velocity, process_.acceleration};
  if (leaves_travel(next)) {
    take_away();
    advance_own(dt, 0);
    return;
  }
  set_ = next;
}

void Axis::advance_geared(double dt) noexcept {
  if (!leaves_travel(geared_, true)) {
    set_ = geared_;
    return;
  }
  take_away();
  advance_own(dt, 0);
}

void Axis::advance_own(double dt, image::Nanoseconds now) noexcept {
  if (torque_.leads()) return advance_torque(dt);
  if (!stopped_by_reaction_) {
    if (homing_.active())
      advance_homing(dt);
    else if (manual_ != Manual::rest)
      advance_manual(now);
    if (!homing_reported_ && homing_.state() == Homing::State::failed)
      raise(homing_.failure(), homing_.failure_limit(), homing_.failure_value());
    homing_reported_ = homing_reported_ || !homing_.active();
  }
  if (homing_.drive_leads() && !homing_.active()) homing_.bring_back(homing_inputs(dt));
  if (homing_.drive_leads()) return follow_drive();
  set_ = ramp_.step(dt);
  if (!ramp_.done() || homing_.active()) return;
  if (manual_ == Manual::plc && !feed_enable_) return;  // held on its way
  set_.v = set_.a = 0.0;
  end_jog(manual_ == Manual::increment ? image::JogEnd::arrived : image::JogEnd::travel);
  own_motion_ = false;
  manual_ = Manual::rest;
  if (owner_ == AxisOwner::manual || owner_ == AxisOwner::homing || geared()) owner_ = AxisOwner::none;
}

void Axis::advance_homing(double dt) noexcept {
  if (!feed_enable_) {
    break_homing(image::JogEnd::feed);
    return;
  }
  homing_.step(ramp_, homing_inputs(dt));
  if (!homing_.take_reference()) return;
  set_machine_position(homing_.captured_counts());
  if (homing_.missed_edge()) raise(alarm::kHomingNoEdge, 0.0, config_.homing.position);
  check_index_place();
}

/// The set-point goes along with the axis: where it is by now, at the speed it has. From there it brakes.
void Axis::advance_torque(double dt) noexcept {
  using Failure = TorqueControl::Failure;
  const Failure failure =
      torque_.step({dt, drive_.mode, actual_velocity_, config_.standstill_velocity, feed_enable_});
  if (failure == Failure::too_fast)
    raise(alarm::kTorqueTooFast, torque_.velocity_limit(), std::abs(actual_velocity_));
  else if (failure != Failure::none)
    raise(alarm::kTorqueModeRefused, failure == Failure::no_return ? 1.0 : 0.0, torque_.wanted());
  if (failure != Failure::none && !stopped_by_reaction_) take_away();
  const double speed = actual_standing_ ? 0.0 : actual_velocity_;
  set_ = {actual_ + speed * dt * config_.feedback_delay, speed, 0.0};
  if (homed_) compensation_value_ = compensation_.at(set_.x);
  compensation_.seat(set_.x, speed > 0.0 ? 1 : speed < 0.0 ? -1 : 0);
  ramp_.reset(set_, config_.limits);
  fill_history(speed * dt);
  if (!torque_.leads() && manual_ == Manual::torque) manual_ = Manual::rest;
}

/// The drive homes by itself: the set-point is where it is, and nothing falls behind.
void Axis::follow_drive() noexcept {
  set_ = {actual_, 0.0, 0.0};
  compensation_.seat(actual_, 0);
  ramp_.reset(set_, config_.limits);
  fill_history();
}

/// A zero mark close to the edge of the switch is taken today and missed tomorrow.
void Axis::check_index_place() noexcept {
  const HomingData& data = config_.homing;
  if (data.method != HomingMethod::switch_and_index || !(data.index_spacing > 0.0)) return;
  const double way = std::abs(scale_.velocity(static_cast<double>(homing_.index_distance_counts())));
  const double margin = 0.1 * data.index_spacing;
  if (way < margin || way > data.index_spacing - margin) raise(alarm::kHomingIndexNearEdge, margin, way);
}

void Axis::advance_manual(image::Nanoseconds now) noexcept {
  if (manual_ == Manual::plc) return advance_plc();
  const auto silence_ns = static_cast<double>(now - keep_alive_ns_);
  const bool silent = manual_ == Manual::continuous && silence_ns >= config_.keep_alive_s * time_scale_ * 1e9;
  if (!feed_enable_ || silent) return jog_stop(silent ? image::JogEnd::silent : image::JogEnd::feed);
  if (manual_ != Manual::continuous) return;
  const MotionLimits lim = limits_with(jog_speed());
  if (homed_ && config_.travel_limited)
    ramp_.move_to(
        jog_direction_ > 0 ? std::max(config_.travel_max, set_.x) : std::min(config_.travel_min, set_.x),
        lim);
  else
    ramp_.move_at(jog_direction_ * lim.velocity, lim);
}

void Axis::advance_plc() noexcept {
  if (!feed_enable_)
    ramp_.stop(config_.limits);
  else if (goal_endless_)
    ramp_.move_at(goal_, goal_limits_);
  else
    ramp_.move_to(goal_, goal_limits_);
}

/// The first cause of a jog's end is its cause.
void Axis::end_jog(image::JogEnd why) noexcept {
  const bool jogs = manual_ == Manual::increment || manual_ == Manual::continuous;
  if (jogs && jog_end_ == image::JogEnd::none) jog_end_ = why;
}

void Axis::break_homing(image::JogEnd why) noexcept {
  homing_.abort(ramp_);
  raise(alarm::kHomingInterrupted, 0.0, set_.x, static_cast<double>(why));
}

/// Ends whatever motion there is, at the axis' own limits.
void Axis::take_away(image::JogEnd why) noexcept {
  end_jog(why);
  if (homing_.active()) break_homing(why);
  torque_.leave();
  manual_ = Manual::rest;
  ramp_.reset(set_, config_.limits);
  own_motion_ = true;
  stopped_by_reaction_ = true;
}

/// As if the set-point had come here with this step a cycle; what is sent in this cycle comes on top.
void Axis::fill_history(double step) noexcept {
  for (int ago = 0; ago < kHistory; ++ago)
    history_[static_cast<std::size_t>((head_ + kHistory - ago) % kHistory)] = {set_.x - step * (ago + 1),
                                                                               compensation_value_};
}

/// The drive does not hold the axis: the set-point is where the axis is.
void Axis::follow_feedback() noexcept {
  if (homing_.active()) break_homing(image::JogEnd::power);
  homing_.drop();
  torque_.drop();
  if (homed_) compensation_value_ = compensation_.at(motor_ - compensation_value_);
  actual_ = motor_ - compensation_value_;
  set_ = {actual_, 0.0, 0.0};
  compensation_.seat(actual_, 0);
  ramp_.reset(set_, config_.limits);
  fill_history();
  end_jog(image::JogEnd::power);
  manual_ = Manual::rest;
  own_motion_ = moving_ = false;
  stopped_by_reaction_ = false;
  following_error_ = 0.0;
  if (owner_ != AxisOwner::process) owner_ = AxisOwner::none;
}

/// Makes `counts` the home position without moving the drive.
void Axis::set_machine_position(std::int64_t counts) noexcept {
  off_path_ = false;
  const double old_motor = scale_.position(drive_.position_counts);
  const double target = set_.x + compensation_value_;
  scale_.reference_counts = counts;
  scale_.reference_position = config_.homing.position;
  motor_ = scale_.position(drive_.position_counts);
  const double motor_target = target + (motor_ - old_motor);
  homed_ = true;
  double x = motor_target;
  for (int i = 0; i < 4; ++i) x = motor_target - compensation_.at(x);
  compensation_value_ = compensation_.at(x);
  set_ = {x, 0.0, 0.0};
  compensation_.seat(x, 0);
  ramp_.reset(set_, config_.limits);
  fill_history();
  actual_ = motor_ - compensation_value_;
}

/// Not homed any more: the compensation goes from the drive command into the set-point, so nothing moves.
void Axis::drop_reference() noexcept {
  if (!homed_ || config_.homing.method == HomingMethod::none ||
      config_.homing.method == HomingMethod::absolute)
    return;
  homed_ = false;
  path_end_ += compensation_value_;
  ramp_.shift(compensation_value_);
  set_.x += compensation_value_;
  for (Sent& s : history_) s = {s.command + s.compensation, 0.0};
  compensation_value_ = 0.0;
}

void Axis::write_drive(image::ProcessImage& image, const PowerSequence::Outputs& power) const noexcept {
  image::DriveCommand& out = image.axes[static_cast<std::size_t>(index_)].drive_command;
  out.power = power.power;
  out.quick_stop = power.quick_stop;
  out.reset_fault = reset_pending_;
  out.brake_release = power.brake_release && config_.brake.output == BrakeOutput::drive;
  const DriveLedHoming& led = homing_.drive_led();
  out.mode = led.wants_homing_mode() ? image::DriveMode::homing
             : torque_.wants_mode()  ? image::DriveMode::cst
                                     : image::DriveMode::csp;
  out.torque_permille = torque_.command() * 10.0 * scale_.direction;
  out.halt = led.wants_halt();
  out.quick_stop = out.quick_stop || led.wants_quick_stop();
  // Homing looks for the zero mark; nobody measures meanwhile.
  const bool probes = probe_armed_ && !homing_.latch_arm();
  out.latch_source = probes ? probe_source_ : image::LatchSource::zero_mark;
  out.latch_negative = probes && probe_negative_;
  out.latch_arm = probes || homing_.latch_arm();
  out.position_counts = held_ ? scale_.counts(set_.x + compensation_value_) : drive_.position_counts;
  out.velocity_counts_s = held_ ? scale_.velocity_counts(set_.v) : 0.0;
  if (config_.brake.output == BrakeOutput::place)
    image.packets.set_bit(config_.brake.place.place, power.brake_release != config_.brake.place.inverted);
}

void Axis::write_image(image::ProcessImage& image, const PowerSequence::Outputs& power) const noexcept {
  image::AxisImage& out = image.axes[static_cast<std::size_t>(index_)];
  out.command = set_.x;
  out.command_velocity = set_.v;
  out.command_acceleration = set_.a;
  out.actual = actual_;
  out.process = static_cast<std::int8_t>(assigned_);
  out.following_error = following_error_;
  out.distance_to_go = own_motion_                               ? ramp_.target() - set_.x
                       : owner_ == AxisOwner::process && moving_ ? process_.distance_to_go
                                                                 : 0.0;
  out.owner = owner_;
  out.jog_end = jog_end_;
  // A spindle has its own power: nothing is missing to the axis that it may become.
  out.enabled = asleep_ ? power_requested_ && power_permitted_ : power_.motion_permitted();
  out.homed = homed_;
  out.in_position = in_position_;
  out.moving = moving_;
  out.brake_released = power.brake_release;

  using image::field;
  using image::kAxisFields;
  const std::uint32_t base = image::axis_base(index_);
  auto put = [&](const image::Place& p, bool value) __attribute__((always_inline)) {
    image::put_bit(image.packets, image::at(p, base), value);
  };
  const bool follows = !asleep_ && drive_.state == image::DriveState::operation_enabled;
  put(field(kAxisFields, "enabled"), drive_.online && follows);
  put(field(kAxisFields, "homed"), homed_);
  put(field(kAxisFields, "in_position"), in_position_);
  put(field(kAxisFields, "moving"), moving_);
  put(field(kAxisFields, "on_limit_plus"), limit_plus_);
  put(field(kAxisFields, "on_limit_minus"), limit_minus_);
  put(field(kAxisFields, "brake_release"), power.brake_release);
  image.packets.set_number(image::at(field(kAxisFields, "owner"), base), static_cast<double>(owner_));
  image.packets.set_number(image::at(field(kAxisFields, "position"), base), actual_);
}

}  // namespace servogate::axis
