// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "kernel/axis/config/axis_config.hpp"
#include "kernel/axis/setpoint/ramp.hpp"

namespace servogate::axis {

/// Backlash and pitch-error compensation of one axis: what is added to the set-point on its way to the drive.
/// Zero by definition at the home position when reached in the direction of homing, so that homing and
/// compensation never move one another. A change of direction passes from one side to the other on a
/// jerk-limited ramp.
class Compensation {
 public:
  static constexpr int kMaxPoints = 1024;

  /// Takes the tables (at most kMaxPoints points). Allocates; not for the cycle.
  void configure(const AxisConfig& config);
  /// True when there is anything to compensate. real-time safe.
  bool present() const noexcept { return present_; }
  /// Follows the set-point by one cycle; gives the compensation for it. real-time safe.
  double step(double position, double dt) noexcept;
  /// Compensation at a position on the side in force, without moving on. real-time safe.
  double at(double position) const noexcept;
  /// Side in force: 1 positive, 0 negative, between during a reversal. real-time safe.
  double side() const noexcept { return side_.state().x; }
  /// Takes a position without regarding it as motion (homing, enabling); `direction` 0 keeps the side.
  /// real-time safe.
  void seat(double position, int direction) noexcept;

 private:
  double table(double position, double side) const noexcept;

  std::vector<PitchPoint> points_;
  bool present_ = false;
  double backlash_ = 0.0;
  double hysteresis_ = 0.0;
  double zero_ = 0.0;
  double last_ = 0.0;
  double reversal_ = 0.0;
  int direction_ = 1;
  Ramp side_;
  MotionLimits side_limits_;
};

}  // namespace servogate::axis
