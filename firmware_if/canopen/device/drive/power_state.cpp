// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/drive/power_state.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;

// 1, 5: slow down ramp; 2, 6: quick stop ramp; 3, 4, 7, 8: current or voltage limit; 0: no drive function.
constexpr StopKind kind_of(std::int16_t option) noexcept {
  switch (option) {
    case 0:
      return StopKind::none;
    case 1:
    case 5:
      return StopKind::slow_down_ramp;
    case 2:
    case 6:
      return StopKind::quick_stop_ramp;
    default:
      return StopKind::torque_limit;
  }
}

}  // namespace

void PowerState::reset() noexcept {
  disable(DriveState::not_ready_to_switch_on);
  fault_requested_ = false;
  reset_level_ = true;
}

void PowerState::enter(DriveState state) noexcept {
  if (state != state_) ++transitions_;
  state_ = state;
}

// The drive function is off from now on; a brake falls in.
void PowerState::disable(DriveState state) noexcept {
  energised_ = enabling_ = engaging_ = brake_released_ = false;
  stop_ = StopKind::none;
  enter(state);
}

void PowerState::stop_then(StopKind kind, DriveState state) noexcept {
  after_stop_ = state;
  if (kind == StopKind::none) return disable(state);
  stop_ = kind;
}

void PowerState::fault(bool coast) noexcept {
  if (state_ == DriveState::fault) return;
  fault_requested_ = true;
  coast_ |= coast;
}

void PowerState::tick(const PowerInputs& in, image::Nanoseconds step) noexcept {
  step_ = step;
  const bool reset_level = in.controlword & controlword::kFaultReset;
  const bool reset_edge = reset_level && !reset_level_;
  reset_level_ = reset_level;
  reset_held_ns_ = reset_level && state_ == DriveState::fault ? reset_held_ns_ + step : 0;
  const bool reset = reset_needed_ns_ > 0 ? reset_held_ns_ >= reset_needed_ns_ : reset_edge;
  if (fault_requested_) return react_to_fault(in);
  if (in.hold_state) return;
  const ControlCommand command = decode_command(in.controlword);
  switch (state_) {
    case DriveState::not_ready_to_switch_on:
      enter(DriveState::switch_on_disabled);  // transition 1
      return;
    case DriveState::switch_on_disabled:
    case DriveState::ready_to_switch_on:
    case DriveState::switched_on:
      return idle(in, command);
    case DriveState::operation_enabled:
      return enabled(in, command);
    case DriveState::quick_stop_active:
      return quick_stopping(in, command);
    case DriveState::fault_reaction_active:
      return finish_stop(in);  // transition 14
    case DriveState::fault:
      if (reset && !in.fault_cause) enter(DriveState::switch_on_disabled);  // transition 15
      return;
    case DriveState::offline:
      return;
  }
}

void PowerState::idle(const PowerInputs& in, ControlCommand command) noexcept {
  if (state_ == DriveState::switch_on_disabled) {
    if (command == ControlCommand::shutdown && in.torque_allowed) enter(DriveState::ready_to_switch_on);  // 2
    return;
  }
  if (command == ControlCommand::disable_voltage || command == ControlCommand::quick_stop ||
      !in.torque_allowed)
    return disable(DriveState::switch_on_disabled);  // 7, 10
  if (state_ == DriveState::ready_to_switch_on) {
    const bool on = command == ControlCommand::switch_on || command == ControlCommand::enable_operation;
    if (on && in.main_voltage) enter(DriveState::switched_on);  // 3
    return;
  }
  if (command == ControlCommand::shutdown || !in.main_voltage)
    return disable(DriveState::ready_to_switch_on);  // 6
  if (command == ControlCommand::enable_operation) return energise(step_);
  if (enabling_) disable(DriveState::switched_on);
}

// Transition 4. With a holding brake the motor holds first, the brake opens, and then the state is entered.
void PowerState::energise(image::Nanoseconds step) noexcept {
  if (!enabling_) {
    enabling_ = energised_ = brake_released_ = true;
    brake_left_ = release_ns_;
  }
  if (brake_left_ > 0) {
    brake_left_ -= step;
    return;
  }
  enabling_ = false;
  enter(DriveState::operation_enabled);
}

void PowerState::enabled(const PowerInputs& in, ControlCommand command) noexcept {
  const OptionCodes& o = in.options;
  switch (command) {
    case ControlCommand::disable_voltage:
      return disable(DriveState::switch_on_disabled);  // 9
    case ControlCommand::quick_stop:
      if (o.quick_stop == 0) return disable(DriveState::switch_on_disabled);
      enter(DriveState::quick_stop_active);  // 11
      quick_stop_left_ = pdo_cycle_ns_;
      engaging_ = false;
      return stop_then(kind_of(o.quick_stop), DriveState::switch_on_disabled);
    case ControlCommand::shutdown:
      if (stop_ == StopKind::none || after_stop_ != DriveState::ready_to_switch_on)
        stop_then(kind_of(o.shutdown), DriveState::ready_to_switch_on);  // 8
      break;
    case ControlCommand::switch_on:
      if (stop_ == StopKind::none || after_stop_ != DriveState::switched_on)
        stop_then(kind_of(o.disable_operation), DriveState::switched_on);  // 5
      break;
    case ControlCommand::enable_operation:
      stop_ = StopKind::none;
      engaging_ = false;
      brake_released_ = true;
      return;
  }
  finish_stop(in);
}

void PowerState::quick_stopping(const PowerInputs& in, ControlCommand command) noexcept {
  if (command == ControlCommand::disable_voltage) return disable(DriveState::switch_on_disabled);  // 12
  if (in.options.quick_stop < 5) {
    quick_stop_left_ -= step_;
    if (quick_stop_left_ < 0) finish_stop(in);  // 12
    return;
  }
  if (command != ControlCommand::enable_operation) return;
  stop_ = StopKind::none;
  enter(DriveState::operation_enabled);  // 16
}

void PowerState::react_to_fault(const PowerInputs& in) noexcept {
  fault_requested_ = false;
  const bool coast = coast_ || !energised_ || kind_of(in.options.fault_reaction) == StopKind::none;
  coast_ = false;
  enabling_ = engaging_ = false;
  if (coast) {
    disable(DriveState::fault_reaction_active);  // 13; the reaction has ended at once
    after_stop_ = DriveState::fault;
    return;
  }
  enter(DriveState::fault_reaction_active);
  stop_then(kind_of(in.options.fault_reaction), DriveState::fault);
}

// Ramp down, brake in, wait, power off.
void PowerState::finish_stop(const PowerInputs& in) noexcept {
  if (energised_ && stop_ != StopKind::none) {
    if (!in.standstill && !engaging_) return;
    if (!engaging_) {
      engaging_ = true;
      brake_released_ = false;
      brake_left_ = engage_ns_;
    }
    if (brake_left_ > 0) {
      brake_left_ -= step_;
      return;
    }
    disable(after_stop_);
  } else if (state_ == DriveState::fault_reaction_active) {
    disable(DriveState::fault);
  }
}

}  // namespace servogate::canopen
