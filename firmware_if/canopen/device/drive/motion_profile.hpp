// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace servogate::canopen {

/// A set-point in encoder counts and seconds.
struct DriveSetpoint {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;
};

/// A set-point of profile position mode with the values that its motion has, taken together at the rising
/// edge of bit 4 of the controlword. Counts and seconds. Source: CiA 402-2, "Profile position mode".
struct SetPoint {
  std::int64_t object = 0;        ///< 607Ah
  bool relative = false;          ///< bit 6: to the target before it
  bool change_on_target = false;  ///< bit 9: the motion before it does not stop at its target
  double velocity = 0.0;          ///< 6081h
  double end_velocity = 0.0;      ///< 6082h
  double acceleration = 0.0;      ///< 6083h
  double deceleration = 0.0;      ///< 6084h
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

/// One step of a trapezoidal motion to `target`, to be at rest there or, with `end` > 0, to pass it with that
/// speed (or with what acceleration allows). True when it is there or has passed it. real-time safe.
inline bool approach_position(DriveSetpoint& s, double target, double speed, double acceleration,
                              double deceleration, double h, double end = 0.0) noexcept {
  const double distance = target - s.position;
  const double d = deceleration * h;
  // Half a count is below the encoder's resolution; the speed left over is that of the last step.
  if (std::abs(distance) < 0.5 && std::abs(s.velocity) <= (end > 0.0 ? 0.0 : 2.0 * d)) {
    s = {target, 0.0, 0.0};
    return true;
  }
  // Highest speed after this step from which the way that is left then suffices when speed falls by d a step.
  const double magnitude = std::abs(distance), last = std::min(end, speed);
  const double left = magnitude - 0.5 * h * std::copysign(s.velocity, s.velocity * distance);
  const double root = 0.25 * d * d + last * last + 2.0 * deceleration * left;
  const double braking = std::max(last, std::sqrt(std::max(0.0, root)) - 0.5 * d);
  const double wanted = last > 0.0 ? std::min(speed, braking) : std::min({speed, braking, magnitude / h});
  ramp_velocity(s, std::copysign(wanted, distance), acceleration, deceleration * 1.0001, h);
  return last > 0.0 && (target - s.position) * distance <= 0.0;
}

}  // namespace servogate::canopen
