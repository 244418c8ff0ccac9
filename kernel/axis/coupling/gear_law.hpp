// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/axis/setpoint/ramp.hpp"

namespace servogate::axis {

/// Where a follower is led to, in its own units.
struct GearTarget {
  MotionState now;     ///< where it should be at the end of the cycle before
  MotionState next;    ///< the same of this cycle; of a set-point only
  bool exact = false;  ///< `next` is a set-point, which may be taken as it is
  bool placed = true;  ///< false: only its speed counts, its place is not chosen yet
};

/// The set-point of an axis that is led to a moving place. Velocity, acceleration and jerk of the axis hold
/// whatever the place does. Far off it goes there as fast as they permit beside the motion of the place; near
/// by it settles (path::kMasterSettles); and where a set-point of its master is inside its limits, it takes
/// that as it is. All functions are real-time safe.
class GearLaw {
 public:
  void begin() noexcept { takes_ = false; }
  /// The state behind `from`, one cycle on.
  MotionState step(const MotionState& from, const GearTarget& target, const MotionLimits& limits,
                   double dt) noexcept;
  /// Speed off its target within which a follower has that speed. real-time safe.
  static double at_speed(const MotionLimits& limits) noexcept;

 private:
  bool takes_ = false;  ///< the set-point of its master, as it is
};

}  // namespace servogate::axis
