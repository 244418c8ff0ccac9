// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

namespace servogate::axis {

/// Limits of one axis; all positive. mm or degrees, seconds.
struct MotionLimits {
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;

  bool operator==(const MotionLimits&) const = default;
};

/// A state of motion at one instant.
struct MotionState {
  double x = 0.0;
  double v = 0.0;
  double a = 0.0;
};

/// Jerk-limited motion of a single axis, on line: from any state to a target position at rest, or to a target
/// velocity. A new target may come in any cycle; position, velocity and acceleration stay continuous and no
/// limit is exceeded, as long as the state at that moment is one that the limits permit (every state that a
/// ramp with the same or tighter limits passes through is). A state outside the limits is brought back inside
/// them at once.
///
/// Exactly at its end the ramp gives the target position itself, velocity 0 and acceleration 0. Moves from
/// rest are time-optimal; moves from another state are so unless the target lies between the shortest stop
/// and the stop after the acceleration present has been taken away (there a little slower).
class Ramp {
 public:
  /// Takes over a state at rest or in motion; keeps it (velocity ramp to 0 with `limits`).
  /// A state without motion is done at once. real-time safe.
  void reset(const MotionState& state, const MotionLimits& limits) noexcept;
  /// To `target` at rest, not faster than the limits. Repeating the same target and limits changes nothing.
  /// Bounded work (about 60 evaluations of a closed form). real-time safe.
  void move_to(double target, const MotionLimits& limits) noexcept;
  /// To a lasting velocity (clamped to the limit). real-time safe.
  void move_at(double velocity, const MotionLimits& limits) noexcept;
  /// Shortest stop within the limits. real-time safe.
  void stop(const MotionLimits& limits) noexcept { move_at(0.0, limits); }
  /// Advances by `dt` seconds and gives the new state. real-time safe.
  const MotionState& step(double dt) noexcept;
  /// Moves the coordinate system by `delta` (new = old + delta): the machine position was set. real-time
  /// safe.
  void shift(double delta) noexcept;

  const MotionState& state() const noexcept { return state_; }
  /// True at rest with no way left to go. real-time safe.
  bool done() const noexcept { return phase_ >= count_ && state_.v == 0.0 && state_.a == 0.0; }
  /// Where it will come to rest; for a lasting velocity the present position. real-time safe.
  double target() const noexcept { return to_position_ ? target_ : state_.x; }
  /// Seconds until the target is reached. real-time safe.
  double time_left() const noexcept { return left_ > 0.0 ? left_ : 0.0; }

  /// Displacement of the shortest stop from a state. real-time safe.
  static double stopping_distance(const MotionState& state, const MotionLimits& limits) noexcept;

 private:
  struct Phase {
    double duration = 0.0, jerk = 0.0;
    MotionState start;
  };
  static constexpr int kMaxPhases = 10;

  void begin(const MotionLimits& limits) noexcept;
  void append_velocity_ramp(double velocity, int sign) noexcept;
  void append(double duration, double jerk) noexcept;

  std::array<Phase, kMaxPhases> phases_{};
  int count_ = 0;
  int phase_ = 0;       ///< phase under way, count_: behind the last
  double local_ = 0.0;  ///< time in it
  double left_ = 0.0;
  MotionState state_;
  MotionState end_;  ///< behind the last phase
  MotionLimits limits_;
  double target_ = 0.0;
  double target_velocity_ = 0.0;
  bool to_position_ = false;
};

}  // namespace servogate::axis
