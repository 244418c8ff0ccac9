// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/control/power_sequence.hpp"

namespace servogate::axis {

using image::DriveState;
using image::Reaction;

namespace {

constexpr double kSag = 0.010;  ///< s in which a load shows that it sags as its brake opens

/// In a quick stop: the drive still has its torque.
bool brakes(DriveState drive) noexcept {
  return drive == DriveState::operation_enabled || drive == DriveState::quick_stop_active ||
         drive == DriveState::fault_reaction_active;
}

}  // namespace

void PowerSequence::configure(const BrakeData& brake) noexcept {
  brake_ = brake;
  state_ = State::off;
  in_state_s_ = 0.0;
  drive_on_ = quick_ = lost_ = false;
}

void PowerSequence::enter(State s) noexcept {
  state_ = s;
  in_state_s_ = 0.0;
}

/// The way out that does not wait for a ramp.
void PowerSequence::drop(const Inputs& in) noexcept {
  if (in.reaction == Reaction::power_off) {
    quick_ = has_brake();
    enter(has_brake() ? State::engaging : State::off);
  } else if (in.reaction == Reaction::quick_stop && !quick_) {
    quick_ = true;
    enter(State::stopping);
  } else if (state_ >= State::torque && (quick_ ? !brakes(in.drive) : !drive_on_)) {
    lost_ = true;  // the brake closes at once
    enter(State::off);
  }
}

/// A load that hangs on the brake sags into the position loop as it opens: motion begins from rest, and waits
/// no longer for it than for the brake.
bool PowerSequence::open_and_settled(const Inputs& in) const noexcept {
  const double seen = brake_.command_time + brake_.release_delay + in.feedback_s + kSag;
  return in_state_s_ >= seen && (in.standing || in_state_s_ >= seen + brake_.release_delay);
}

PowerSequence::Outputs PowerSequence::step(const Inputs& in) noexcept {
  in_state_s_ += in.dt;
  lost_ = false;
  drive_on_ = in.drive == DriveState::operation_enabled;
  const bool forced = in.reaction == Reaction::power_off && state_ == State::engaging;
  if (state_ != State::off && !forced) {
    drop(in);
    if (state_ == State::off) return {};
  }
  switch (state_) {
    case State::off:
      quick_ = false;
      if (in.wanted && in.reaction < Reaction::stop_and_power_off) enter(State::powering);
      break;
    case State::powering:
      if (!in.wanted)
        enter(State::off);
      else if (drive_on_)
        enter(State::torque);
      break;
    case State::torque:
      if (!in.wanted)
        enter(State::engaging);
      else if (!has_brake())
        enter(State::ready);
      else if (in_state_s_ >= brake_.torque_delay)
        enter(State::releasing);
      break;
    case State::releasing:
      if (!in.wanted)
        enter(State::engaging);
      else if (open_and_settled(in))
        enter(State::ready);
      break;
    case State::ready:
      if (!in.wanted) enter(State::stopping);
      break;
    case State::stopping:
      if (in.at_rest) enter(State::engaging);
      break;
    case State::engaging:
      break;
  }
  if (state_ == State::engaging && (!has_brake() || in_state_s_ >= brake_.command_time + brake_.engage_delay))
    enter(State::off);
  const bool open = state_ == State::releasing || state_ == State::ready || state_ == State::stopping;
  return {state_ != State::off, open && has_brake(), quick_ && state_ != State::off};
}

}  // namespace servogate::axis
