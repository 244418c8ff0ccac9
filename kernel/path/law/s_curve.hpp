// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "kernel/path/bound/bound.hpp"

namespace servogate::path {

/// Place, speed and acceleration along the path parameter.
struct MotionState {
  double s = 0.0, v = 0.0, a = 0.0;
};

/// Some phases of constant jerk, run one after the other. The whole class is real-time safe.
class Profile {
 public:
  static constexpr int kMaxPhases = 8;
  /// Begins anew at this state, with no phases.
  void start(const MotionState& state) noexcept;
  /// Appends `duration` seconds of `jerk`; nothing when the duration is not positive.
  void add(double duration, double jerk) noexcept;
  /// Fixes the state that is reached when the last phase ends, so that no rounding error stays.
  void finish_at(const MotionState& state) noexcept { end_ = state; }
  /// State `t` seconds after the start (0 <= t; the end state from duration() on).
  MotionState at(double t) const noexcept;
  /// Jerk `t` seconds after the start; 0 behind the last phase.
  double jerk(double t) const noexcept {
    return t >= duration_ || count_ == 0 ? 0.0 : phases_[phase(t)].jerk;
  }
  /// When a phase begins, 0 <= n < size().
  double begins(int n) const noexcept { return phases_[static_cast<std::size_t>(n)].begins; }
  double duration() const noexcept { return duration_; }
  /// State after the last phase.
  const MotionState& end() const noexcept { return end_; }
  int size() const noexcept { return count_; }

 private:
  struct Phase {
    MotionState from;
    double begins, jerk;
  };
  /// Number of the one that `t` lies in; one there must be.
  std::size_t phase(double t) const noexcept {
    auto k = static_cast<std::size_t>(count_ - 1);
    while (k > 0 && t < phases_[k].begins) --k;
    return k;
  }
  std::array<Phase, kMaxPhases> phases_{};
  int count_ = 0;
  double duration_ = 0.0;
  MotionState end_;
};

/// Distance of the fastest change of speed from (v0, a0) to (v1, 0). real-time safe.
double ramp_distance(double v0, double a0, double v1, const Box& box) noexcept;

/// Appends that change to a profile that ends in (v0, a0). real-time safe.
void add_ramp(Profile& profile, double v0, double a0, double v1, const Box& box) noexcept;

/// Highest speed from which rest is reached within `length`, acceleration 0 at both ends. real-time safe.
double reachable_speed(double length, const Box& box) noexcept;

/// What the profile up to a rest is asked for.
struct Goal {
  double length = 0.0;    ///< from the state's place to where it rests
  double velocity = 0.0;  ///< speed to hold, <= the box's; 0: come to rest as soon as possible
};

/// The fastest profile from `state` that keeps the box and rests at the end of the length; with velocity 0 it
/// rests before it where it can. False, and the profile untouched, when there is none: the one that is being
/// followed is then the way to go on. real-time safe: at most some hundred operations of arithmetic.
bool plan(Profile& profile, const MotionState& state, const Goal& goal, const Box& box) noexcept;

}  // namespace servogate::path
