// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/drive/drive_link.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {

using image::DriveMode;
using image::DriveState;

namespace {

std::uint64_t clamped(double value, double limit) noexcept {
  if (!(value == value)) return 0;
  return static_cast<std::uint64_t>(std::llround(std::clamp(value, -limit, limit)));
}

/// Over SDO a controlword may wait for its turn.
constexpr std::int32_t kResetHoldBySdoMs = 300;

DriveControl::Timing timing_of(const DriveProfile& profile) {
  const std::int32_t hold_ms = profile.sdo_only ? std::max(profile.fault_reset_hold_ms, kResetHoldBySdoMs)
                                                : profile.fault_reset_hold_ms;
  return {profile.fault_reset, hold_ms * image::kMillisecond,
          profile.transition_timeout_ms * image::kMillisecond};
}

/// Of a drive that only answers SDO the objects of the cycle have their places here, too, and no frame
/// carries them.
DriveProfile with_places(const NodeConfig& node) {
  DriveProfile profile = node.profile;
  if (!profile.sdo_only) return profile;
  const bool axis = node.target == DriveTarget::axis, vl = profile.velocity_mode == OperationMode::velocity;
  const auto place = [](std::uint16_t index, std::uint8_t bits) {
    PdoWanted pdo;
    pdo.mapping.add({index, 0, bits});
    return pdo;
  };
  const PdoWanted speed = vl ? place(object::kVlTargetVelocity, 16) : place(object::kTargetVelocity, 32);
  const PdoWanted turns = vl ? place(object::kVlVelocityActual, 16) : place(object::kVelocityActual, 32);
  profile.rpdo = {place(object::kControlword, 16), axis ? place(object::kTargetPosition, 32) : speed};
  profile.tpdo = {place(object::kStatusword, 16), axis ? place(object::kPositionActual, 32) : turns};
  return profile;
}

}  // namespace

DriveLink::DriveLink(const NodeConfig& node, const SegmentConfig& segment)
    : profile_(with_places(node)),
      target_(node.target),
      cycle_ns_(segment.cycle_ns),
      watch_(profile_.tpdo, segment.cycle_ns, max_missed_pdo(node, segment)),
      handover_counts_(profile_.handover_counts ? profile_.handover_counts
                                                : std::max<std::int64_t>(1, profile_.counts_per_rev / 4)),
      data_(profile_, segment.cycle_ns),
      control_(timing_of(profile_)) {
  const auto& rpdo = profile_.rpdo;
  out_.controlword = find_field(rpdo, object::kControlword);
  out_.target_position = find_field(rpdo, object::kTargetPosition);
  if (!out_.target_position.mapped())
    out_.target_position = find_field(rpdo, object::kInterpolationData, profile_.ip_position_entry);
  if (profile_.ip_velocity_entry > 0)
    out_.ip_velocity = find_field(rpdo, object::kInterpolationData, profile_.ip_velocity_entry);
  out_.target_velocity = find_field(rpdo, object::kTargetVelocity);
  out_.target_torque = find_field(rpdo, object::kTargetTorque);
  out_.mode = find_field(rpdo, object::kModesOfOperation);
  out_.probe_function = find_field(rpdo, object::kTouchProbeFunction);
  out_.velocity_offset = find_field(rpdo, object::kVelocityOffset);
  out_.vl_velocity = find_field(rpdo, object::kVlTargetVelocity);
  out_.digital_outputs = find_field(rpdo, object::kDigitalOutputs, 1);
  const auto& tpdo = profile_.tpdo;
  in_.statusword = find_field(tpdo, object::kStatusword);
  in_.position = find_field(tpdo, object::kPositionActual);
  in_.velocity = find_field(tpdo, object::kVelocityActual);
  speed_unit_ = profile_.velocity_unit_counts_s;
  if (!in_.velocity.mapped()) {
    in_.velocity = find_field(tpdo, object::kVlVelocityActual);
    speed_unit_ = profile_.vl_unit_counts_s;
  }
  in_.torque = find_field(tpdo, object::kTorqueActual);
  in_.inputs = find_field(tpdo, object::kDigitalInputs);
  in_.error_code = find_field(tpdo, object::kErrorCode);
  in_.mode = find_field(tpdo, object::kModesOfOperationDisplay);
  in_.probe_status = find_field(tpdo, object::kTouchProbeStatus);
  answer_cycles_ =
      std::max<std::int64_t>(1, sdo_timeout_ms(node, segment) * image::kMillisecond / segment.cycle_ns);
  restart();
}

void DriveLink::restart() noexcept {
  data_.clear();
  watch_.restart();
  control_.restart();
  probe_.restart();
  homing_.restart();
  set_points_.restart();
  interpolation_asked_ns_.reset();
  interpolation_waited_ms_ = 0;
  statusword_ = 0;
  status_known_ = false;
  position_known_ = false;
  cycles_since_position_ = 0;
  velocity_counts_s_ = 0.0;
  last_state_ = DriveState::offline;
  error_code_ = 0;
  error_code_wanted_ = false;
  mode_wanted_ = mode_of(DriveMode::none);
  // The boot has written this mode; whether the drive shows it is still to be read.
  mode_written_ = mode_wanted_;
  show_mode(0);
  mode_read_ns_ = 0;
  mode_refused_ = false;
  probe_function_known_ = false;
  probe_refused_ = false;
  stopping_ = false;
  following_ = false;
  handover_difference_ = 0;
  access_ = Access::none;
  buffer_open_wanted_ = buffer_open_ = buffer_refused_ = false;  // the boot has closed it
  waited_ = actual_age_ = 0;
  control_written_.reset();
  target_written_.reset();
}

OperationMode DriveLink::mode_of(DriveMode mode) const noexcept {
  switch (mode) {
    case DriveMode::csp:
      return profile_.position_mode;
    case DriveMode::csv:
      return profile_.velocity_mode;
    case DriveMode::cst:
      return profile_.torque_mode;
    case DriveMode::homing:
      return OperationMode::homing;
    case DriveMode::none:
      break;
  }
  return target_ == DriveTarget::axis ? profile_.position_mode : profile_.velocity_mode;
}

void DriveLink::show_mode(std::int8_t shown) noexcept {
  mode_shown_ = shown;
  mode_meant_ = DriveMode::none;
  for (const DriveMode mode : {DriveMode::csp, DriveMode::csv, DriveMode::cst, DriveMode::homing})
    if (mode_of(mode) == static_cast<OperationMode>(shown)) mode_meant_ = mode;
}

PdoWatch::Overdue DriveLink::overdue() const noexcept {
  if (!profile_.sdo_only) return watch_.overdue();
  if (waited_ < answer_cycles_) return {};
  return {PdoWatch::kSdo, waited_, waited_, answer_cycles_};
}

std::uint32_t DriveLink::missed() const noexcept {
  return static_cast<std::uint32_t>(profile_.sdo_only ? actual_age_ : watch_.overdue().missed);
}

bool DriveLink::update() noexcept {
  ++cycles_since_position_;
  ++actual_age_;
  if (access_ != Access::none) ++waited_;
  const bool status_fresh = data_.fresh(in_.statusword);
  if (status_fresh) {
    statusword_ = static_cast<std::uint16_t>(data_.raw(in_.statusword));
    control_.on_statusword(statusword_);
    status_known_ = true;
    if (mode_shown_ == static_cast<std::int8_t>(OperationMode::profile_position))
      set_points_.on_acknowledge(statusword_ & statusword::kModeSpecific12);
  }
  if (data_.fresh(in_.position)) take_position();
  if (data_.fresh(in_.position) || data_.fresh(in_.velocity)) actual_age_ = 0;
  take_velocity();
  if (data_.fresh(in_.mode)) show_mode(static_cast<std::int8_t>(data_.number(in_.mode)));
  if (status_fresh && mode_meant_ == DriveMode::homing) homing_.on_statusword(statusword_);
  if (data_.fresh(in_.probe_status)) take_probe_by_pdo();
  follow_state();
  const bool on_time = profile_.sdo_only ? waited_ < answer_cycles_ : watch_.step(data_);
  data_.end_of_cycle();
  return on_time && status_known_ && (position_known_ || !profile_.sdo_only || !in_.position.mapped());
}

// 6064h has 32 bits and wraps; the machine counts on in 64.
void DriveLink::take_position() noexcept {
  const auto raw = static_cast<std::int32_t>(data_.number(in_.position));
  if (!position_known_) {
    position_counts_ = raw;
    last_position_counts_ = raw;
    cycles_since_position_ = 0;
    position_known_ = true;
    return;
  }
  position_counts_ += static_cast<std::int32_t>(static_cast<std::uint32_t>(raw) -
                                                static_cast<std::uint32_t>(position_counts_));
}

void DriveLink::take_velocity() noexcept {
  if (in_.velocity.mapped()) {
    if (data_.fresh(in_.velocity))
      velocity_counts_s_ = static_cast<double>(data_.number(in_.velocity)) * speed_unit_;
    return;
  }
  if (!data_.fresh(in_.position) || cycles_since_position_ == 0) return;
  const auto time_s = static_cast<double>(cycles_since_position_ * cycle_ns_) * 1e-9;
  velocity_counts_s_ = static_cast<double>(position_counts_ - last_position_counts_) / time_s;
  last_position_counts_ = position_counts_;
  cycles_since_position_ = 0;
}

void DriveLink::follow_state() noexcept {
  const DriveState state = control_.state();
  const auto in_fault = [](DriveState s) {
    return s == DriveState::fault || s == DriveState::fault_reaction_active;
  };
  if (in_fault(state)) {
    if (!in_fault(last_state_)) error_code_wanted_ = !in_.error_code.mapped();
  } else {
    if (in_fault(last_state_)) error_code_ = 0;
    error_code_wanted_ = false;
  }
  if (data_.fresh(in_.error_code)) error_code_ = static_cast<std::uint16_t>(data_.raw(in_.error_code));
  last_state_ = state;
}

// Status and value must be of the same SYNC; where they are not in one PDO the value is read by SDO.
void DriveLink::take_probe_by_pdo() noexcept {
  probe_.on_status(static_cast<std::uint16_t>(data_.raw(in_.probe_status)));
  if (!probe_.wants_value()) return;
  const PdoField value = find_field(profile_.tpdo, probe_.wants_value());
  if (value.mapped() && value.pdo == in_.probe_status.pdo)
    probe_.on_value(static_cast<std::int32_t>(data_.number(value)), position_counts_);
}

void DriveLink::on_emcy(std::uint16_t error_code) noexcept { error_code_ = error_code; }

void DriveLink::fill(image::DriveFeedback& feedback) const noexcept {
  feedback.state = control_.state();
  feedback.mode = mode_meant_;
  feedback.statusword = statusword_;
  feedback.error_code = error_code_;
  feedback.position_counts = position_counts_;
  feedback.velocity_counts_s = velocity_counts_s_;
  feedback.torque_permille = static_cast<double>(data_.number(in_.torque)) * profile_.torque_unit_permille;
  feedback.torque_known = in_.torque.mapped();
  feedback.digital_inputs = static_cast<std::uint32_t>(data_.raw(in_.inputs));
  feedback.latch_counts = probe_.latch_counts();
  feedback.latch_sequence = probe_.sequence();
  feedback.homing = homing_.state();
  // Home is where the drive counts 0 (the boot writes 607Ch); the machine's 64 bits have gone round
  // meanwhile.
  feedback.home_counts =
      position_counts_ - static_cast<std::int32_t>(static_cast<std::uint32_t>(position_counts_));
  feedback.refusal = control_.refusal();
}

void DriveLink::apply(image::Nanoseconds now, const image::DriveCommand& command, bool blocked) noexcept {
  follow_halt(command);
  const OperationMode mode = stopping_ ? mode_wanted_ : mode_of(command.mode);
  if (mode != mode_wanted_) {
    mode_wanted_ = mode;
    mode_refused_ = false;
  }
  if (!command.latch_arm) probe_refused_ = false;
  probe_.command(command.latch_arm && !probe_refused_, command.latch_source, command.latch_negative);

  DriveControl::Wish wish;
  const bool quick_stop = command.power && (command.quick_stop || blocked);
  wish.power = quick_stop || stopping_ ? PowerWish::quick_stop
               : command.power         ? PowerWish::on
                                       : PowerWish::off;
  wish.reset_fault = command.reset_fault;
  wish.mode_ready = mode_ready();
  wish.start_homing = mode == OperationMode::homing && mode_ready();
  wish.halt = command.halt;
  const std::int64_t target = target_position(command);
  std::uint16_t word = control_.step(now, wish);
  homing_.command(now, wish.start_homing && control_.state() == DriveState::operation_enabled);
  word |= mode_bits(now, target);
  data_.set(out_.controlword, word);
  data_.set(out_.mode, static_cast<std::uint8_t>(mode));
  data_.set(out_.probe_function, probe_.function());
  std::uint64_t outputs = command.digital_outputs;
  if (profile_.brake_bit >= 0) {
    const std::uint64_t brake = std::uint64_t{1} << profile_.brake_bit;
    outputs = command.brake_release == profile_.brake_bit_releases ? outputs | brake : outputs & ~brake;
  }
  data_.set(out_.digital_outputs, outputs);
  set_targets(command, target);
}

// A drive without a halt bit is stopped by its quick stop, which nothing cuts short: neither that the power
// is taken away nor another mode.
void DriveLink::follow_halt(const image::DriveCommand& command) noexcept {
  const DriveState state = control_.state();
  if (command.halt && !profile_.halt && state == DriveState::operation_enabled) stopping_ = true;
  const bool rests = std::abs(velocity_counts_s_) * 1000.0 < static_cast<double>(profile_.counts_per_rev);
  const bool held_by_stop = state == DriveState::quick_stop_active && !rests;
  if (!held_by_stop && state != DriveState::operation_enabled) stopping_ = false;
}

// Until the drive holds the axis its target is where it stands, so that nothing jumps when it begins to
// follow (CiA 402-2, csp: the target position is used from the first SYNC in Operation enabled on).
std::int64_t DriveLink::target_position(const image::DriveCommand& command) noexcept {
  handover_difference_ = 0;
  // While the drive homes by itself it leads: the target goes along with the actual position, also over the
  // new zero, until csp is back and the command is seated on it again.
  const auto homing = static_cast<std::int8_t>(OperationMode::homing);
  const bool drive_leads = mode_wanted_ == OperationMode::homing || mode_shown_ == homing ||
                           (mode_wanted_ == OperationMode::interpolated_position && !interpolating());
  if (drive_leads || control_.state() != DriveState::operation_enabled) {
    following_ = false;
    held_target_ = position_counts_;
    return held_target_;
  }
  if (!following_) {
    const std::int64_t difference = command.position_counts - held_target_;
    following_ = std::abs(difference) <= handover_counts_;
    if (!following_) handover_difference_ = difference;
  }
  return following_ ? command.position_counts : held_target_;
}

void DriveLink::set_targets(const image::DriveCommand& command, std::int64_t target) noexcept {
  const bool enabled = control_.state() == DriveState::operation_enabled;
  const bool by_velocity = mode_wanted_ == profile_.velocity_mode && enabled;
  const bool by_torque = mode_wanted_ == profile_.torque_mode && enabled;
  if (mode_wanted_ == OperationMode::profile_position) target = set_points_.target().value_or(target);
  data_.set(out_.target_position, static_cast<std::uint64_t>(target));
  const double velocity = command.velocity_counts_s / profile_.velocity_unit_counts_s;
  const auto set = [this](const PdoField& field, bool wanted, double value, double limit = 2147483647.0) {
    if (field.mapped()) data_.set(field, wanted ? clamped(value, limit) : 0);
  };
  set(out_.vl_velocity, by_velocity, command.velocity_counts_s / profile_.vl_unit_counts_s, 32767.0);
  set(out_.target_velocity, by_velocity, velocity);
  set(out_.ip_velocity, following_ && !by_velocity, velocity);
  set(out_.velocity_offset, following_ && !by_velocity, velocity);
  set(out_.target_torque, by_torque, command.torque_permille / profile_.torque_unit_permille, 32767.0);
}

}  // namespace servogate::canopen
