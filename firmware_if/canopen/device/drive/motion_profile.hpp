// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

namespace servogate::canopen {

/// A set-point in encoder counts and seconds.
struct DriveSetpoint {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;
};

/// One step of a velocity ramp (linear ramp, 6086h = 0): `acceleration` while the speed grows, `deceleration`
/// while it falls; the position follows as the trapezoid's area. real-time safe.
inline void ramp_velocity(DriveSetpoint& s, double target, double acceleration, double deceleration,
                          double h) noexcept {
  const bool growing =
      s.velocity == 0.0 || (target * s.velocity > 0.0 && std::abs(target) > std::abs(s.velocity));
  double limit = (growing ? acceleration : deceleration) * h;
  double next = s.velocity + std::clamp(target - s.velocity, -limit, limit);
  // Through zero the rest of the step belongs to the new direction; it is given up, which is at most one
  // step.
  if (next * s.velocity < 0.0) next = 0.0;
  s.acceleration = (next - s.velocity) / h;
  s.position += 0.5 * (s.velocity + next) * h;
  s.velocity = next;
}

/// One step of a trapezoidal motion that ends at rest in `target`. True when it is there. real-time safe.
inline bool approach_position(DriveSetpoint& s, double target, double speed, double acceleration,
                              double deceleration, double h) noexcept {
  const double distance = target - s.position;
  const double d = deceleration * h;
  // Half a count is below the encoder's resolution; the speed left over is that of the last step.
  if (std::abs(distance) < 0.5 && std::abs(s.velocity) <= 2.0 * d) {
    s = {target, 0.0, 0.0};
    return true;
  }
  // Highest speed from which the remaining way suffices when speed falls by d a step.
  const double magnitude = std::abs(distance);
  const double braking = std::sqrt(0.25 * d * d + 2.0 * deceleration * magnitude) - 0.5 * d;
  const double wanted = std::min({speed, braking, magnitude / h});
  ramp_velocity(s, std::copysign(wanted, distance), acceleration, deceleration * 1.0001, h);
  return false;
}

}  // namespace servogate::canopen
