// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/homing/drive_led_homing.hpp"

namespace servogate::axis {

using image::DriveHoming;
using image::DriveMode;

namespace {
constexpr double kRest = 0.05;  // s at rest before the drive counts as stopped
}

void DriveLedHoming::enter(Phase phase) noexcept {
  phase_ = phase;
  in_phase_s_ = 0.0;
}

void DriveLedHoming::start() noexcept {
  outcome_ = Outcome::none;
  limit_s_ = 0.0;
  enter(Phase::asking);
}

void DriveLedHoming::break_off(Outcome outcome) noexcept {
  outcome_ = outcome;
  rest_s_ = 0.0;
  enter(Phase::halting);
}

void DriveLedHoming::stop() noexcept {
  if (phase_ == Phase::asking || phase_ == Phase::running) break_off(Outcome::interrupted);
  // The home that was found holds only if nobody changed his mind meanwhile.
  if (phase_ == Phase::returning && outcome_ == Outcome::attained) outcome_ = Outcome::interrupted;
}

void DriveLedHoming::step(const HomingData& data, const DriveLedInputs& in) noexcept {
  in_phase_s_ += in.dt;
  switch (phase_) {
    case Phase::off:
      return;
    case Phase::asking:
      if (in.mode == DriveMode::homing) return enter(Phase::running);
      if (in_phase_s_ > kModePatience) break_off(Outcome::mode_refused);
      return;
    case Phase::running:
      return watch(data, in);
    case Phase::halting:
      rest_s_ = in.standing ? rest_s_ + in.dt : 0.0;
      if (rest_s_ >= kRest) enter(Phase::returning);
      return;
    case Phase::returning:
      if (in.mode == DriveMode::csp) return enter(Phase::off);
      if (in_phase_s_ > kModePatience) outcome_ = Outcome::mode_refused;
      return;
  }
}

void DriveLedHoming::watch(const HomingData& data, const DriveLedInputs& in) noexcept {
  limit_s_ = in.into_limit ? limit_s_ + in.dt : 0.0;
  const bool too_far = in.into_limit && limit_s_ > data.drive_limit_time;
  if (too_far) return break_off(Outcome::limit);
  if (in.homing == DriveHoming::failed) return break_off(Outcome::failed);
  if (in.homing == DriveHoming::interrupted) return break_off(Outcome::interrupted);
  if (in.homing != DriveHoming::attained || !in.standing) return;
  outcome_ = Outcome::attained;
  enter(Phase::returning);
}

}  // namespace servogate::axis
