// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/torque/torque_control.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::axis {
namespace {

constexpr double kModeTime = 1.0;  ///< s for a change of the drive's mode, over SDO as well
constexpr double kGivesWay = 0.5;  ///< of the speed limit: from here on the torque gives way
constexpr double kTooFast = 1.2;   ///< of the speed limit

}  // namespace

void TorqueControl::begin(double torque, double ramp, double velocity_limit) noexcept {
  wanted_ = std::clamp(torque, -data_.max, data_.max);
  ramp_ = ramp > 0.0 ? std::min(ramp, data_.ramp) : data_.ramp;
  velocity_limit_ = velocity_limit;
  if (state_ == State::active || state_ == State::ending) {
    state_ = State::active;
    return;
  }
  state_ = State::entering;
  command_ = 0.0;
  waited_s_ = 0.0;
}

void TorqueControl::end() noexcept {
  if (state_ == State::active) state_ = State::ending;
  if (state_ == State::entering) leave();
}

void TorqueControl::leave() noexcept {
  if (!leads() || state_ == State::returning) return;
  state_ = State::returning;
  command_ = 0.0;
  waited_s_ = 0.0;
}

TorqueControl::Failure TorqueControl::step(const Inputs& in) noexcept {
  switch (state_) {
    case State::off:
      return Failure::none;
    case State::entering:
      return enter(in);
    case State::returning:
      return come_back(in);
    case State::active:
    case State::ending:
      break;
  }
  Failure failure = Failure::none;
  if (in.shown != image::DriveMode::cst) failure = Failure::no_mode;
  if (std::abs(in.velocity) > kTooFast * velocity_limit_ + in.slack) failure = Failure::too_fast;
  if (failure != Failure::none) {
    leave();
    return failure;
  }
  ramp(in);
  if (state_ == State::ending && command_ == 0.0) leave();
  return Failure::none;
}

TorqueControl::Failure TorqueControl::enter(const Inputs& in) noexcept {
  waited_s_ += in.dt;
  if (in.shown == image::DriveMode::cst) {
    state_ = State::active;
  } else if (waited_s_ > kModeTime) {
    leave();
    return Failure::no_mode;
  }
  return Failure::none;
}

TorqueControl::Failure TorqueControl::come_back(const Inputs& in) noexcept {
  const bool in_time = waited_s_ <= kModeTime;
  waited_s_ += in.dt;
  if (in.shown == image::DriveMode::csp) state_ = State::off;
  return leads() && in_time && waited_s_ > kModeTime ? Failure::no_return : Failure::none;
}

void TorqueControl::ramp(const Inputs& in) noexcept {
  const double goal = state_ == State::ending || !in.permitted ? 0.0 : wanted_;
  const double step = ramp_ * in.dt;
  command_ += std::clamp(goal - command_, -step, step);
  const double with_it = std::copysign(1.0, command_) * in.velocity;  // speed in the direction of the torque
  const double share =
      std::clamp((velocity_limit_ - with_it) / ((1.0 - kGivesWay) * velocity_limit_), 0.0, 1.0);
  const double most = share * std::abs(wanted_);
  if (std::abs(command_) > most && share < 1.0) command_ = std::copysign(most, command_);
}

}  // namespace servogate::axis
