// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/drive_control.hpp"

#include <algorithm>

namespace servogate::canopen {

using image::DriveState;
using namespace controlword;

void DriveControl::restart() noexcept {
  const Timing timing = timing_;
  *this = DriveControl(timing);
}

void DriveControl::on_statusword(std::uint16_t word) noexcept {
  state_ = decode_state(word).value_or(state_);
}

std::uint16_t DriveControl::step(image::Nanoseconds now, const Wish& wish) noexcept {
  const bool in_fault = state_ == DriveState::fault || state_ == DriveState::fault_reaction_active;
  if (!wish.reset_fault) reset_used_ = false;
  if (wish.reset_fault && !in_fault) reset_used_ = true;
  if (state_ != DriveState::fault) resetting_ = false;
  DriveState wanted = state_;
  const std::uint16_t word = command(now, wish, wanted);
  watch(now, wanted);
  return word;
}

// `wanted` stays the present state where the drive is asked for nothing.
std::uint16_t DriveControl::command(image::Nanoseconds now, const Wish& wish, DriveState& wanted) noexcept {
  const bool on = wish.power == PowerWish::on;
  const bool quick_stop = wish.power == PowerWish::quick_stop;
  switch (state_) {
    case DriveState::offline:
      return kCommandDisableVoltage;
    case DriveState::not_ready_to_switch_on:
      if (on) wanted = DriveState::switch_on_disabled;
      return kCommandDisableVoltage;
    case DriveState::switch_on_disabled:
      if (!on) return kCommandDisableVoltage;
      wanted = DriveState::ready_to_switch_on;
      return kCommandShutdown;
    case DriveState::ready_to_switch_on:
      wanted = on ? DriveState::switched_on : DriveState::switch_on_disabled;
      return on ? kCommandSwitchOn : quick_stop ? kCommandQuickStop : kCommandDisableVoltage;
    case DriveState::switched_on:
      wanted = on ? DriveState::operation_enabled
                  : (quick_stop ? DriveState::switch_on_disabled : DriveState::ready_to_switch_on);
      if (on) return wish.mode_ready ? kCommandEnableOperation : kCommandSwitchOn;
      return quick_stop ? kCommandQuickStop : kCommandShutdown;
    case DriveState::operation_enabled:
      if (on)
        return static_cast<std::uint16_t>(kCommandEnableOperation | (wish.start_homing ? kModeSpecific4 : 0) |
                                          (wish.halt ? kHalt : 0));
      wanted = quick_stop ? DriveState::quick_stop_active : DriveState::ready_to_switch_on;
      return quick_stop ? kCommandQuickStop : kCommandShutdown;
    case DriveState::quick_stop_active:
      // Where 605Ah keeps the drive here, leaving is our task; Disable voltage is the transition every drive
      // has.
      if (quick_stop) return kCommandQuickStop;
      wanted = DriveState::switch_on_disabled;
      return kCommandDisableVoltage;
    case DriveState::fault_reaction_active:
      wanted = DriveState::fault;
      return kCommandDisableVoltage;
    case DriveState::fault:
      return command_in_fault(now, wish, wanted);
  }
  return kCommandDisableVoltage;
}

std::uint16_t DriveControl::command_in_fault(image::Nanoseconds now, const Wish& wish,
                                             DriveState& wanted) noexcept {
  if (wish.reset_fault && !reset_used_) {
    reset_used_ = true;
    resetting_ = true;
    reset_until_ns_ = now + timing_.reset_hold_ns;
    // A new pulse is watched anew.
    watched_from_ = DriveState::offline;
  }
  if (resetting_) wanted = DriveState::switch_on_disabled;
  const bool pulse = resetting_ && now < reset_until_ns_;
  const bool level = timing_.fault_reset == FaultReset::level && resetting_ && wish.reset_fault;
  return pulse || level ? kCommandFaultReset : kCommandDisableVoltage;
}

void DriveControl::watch(image::Nanoseconds now, DriveState wanted) noexcept {
  if (state_ != watched_from_ || wanted != watched_wanted_) {
    watched_from_ = state_;
    watched_wanted_ = wanted;
    watched_since_ns_ = now;
  }
  refusal_ = {};
  const image::Nanoseconds waited = now - watched_since_ns_;
  if (wanted == state_ || waited < timing_.transition_timeout_ns) return;
  refusal_.from = state_;
  refusal_.wanted = wanted;
  refusal_.waited_ms = static_cast<std::int32_t>(
      std::clamp<image::Nanoseconds>(waited / image::kMillisecond, 1, 2'000'000'000));
}

}  // namespace servogate::canopen
