// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/rate.hpp"

namespace servogate::path {

/// The early branch of a course: the speed along the path goes by constant jerk, by what the path's bend
/// leaves of the axes, whatever the law does there, and law time follows from the place. On the way the rate
/// may be up to kAbove beyond 1, or 2 % while the law speeds up: the law leaves a reserve that the ramp need
/// not leave. Everything here is real-time safe.
class PathRamp {
 public:
  static constexpr double kAbove = 6e-3;
  static constexpr std::size_t kPlans = 7;  ///< the fastest ones first
  /// Looks at the path from here on, once for all plans of the way to `target` times the law's speed, or to
  /// rest where that is the other way round. Counts `places` down by the knots that it looks at. False: the
  /// law rests, or the bend of the path takes nearly all of an axis.
  bool begin(const CourseView& view, const RateLimits& limits, const CourseState& from, double target,
             int& places) noexcept;
  /// One of kPlans. False: the motion would turn round, too little is published, or more knots would be
  /// passed than `places`, which it counts down.
  bool plan(const CourseView& view, const RateLimits& limits, std::size_t number, int& places) noexcept;
  /// Whether it keeps all limits to its end. Counts the places down that it looks at, one between knots for
  /// two, and stops at 0.
  Fit verify(const CourseView& view, const RateLimits& limits, int& places) noexcept;
  /// Back to its start. False: that is not published any more.
  bool rewind(const CourseView& view, const RateLimits& limits) noexcept;
  /// Goes to `t` seconds from its start, 0 <= t <= seconds(); false: that is not published.
  bool go(const CourseView& view, const RateLimits& limits, double t) noexcept;

  double seconds() const noexcept { return profile_.duration(); }
  bool to_rest() const noexcept { return profile_.end().v == 0.0; }
  /// It ends in the rate that is wanted, where the law's speed is constant: the rate holds from there on.
  bool ends_even() const noexcept { return ends_even_; }
  /// Where it has gone; `passed` is not told.
  const RateState& state() const noexcept { return state_; }
  LawTime time() const noexcept;
  std::int64_t knot() const noexcept { return interval_.knot(); }

 private:
  /// The axes and the path where the ramp begins.
  struct Here {
    Box straight;        ///< of the axes in the direction of the path
    Box any;             ///< in any direction
    Vector along{};      ///< velocity of the law
    double curve = 0.0;  ///< curvature of the path, 1/mm
  };
  bool take(const CourseView& view, std::int64_t m, const RateLimits& limits) noexcept;
  bool step_on(const CourseView& view, const RateLimits& limits, bool forwards) noexcept;
  bool move_to(const CourseView& view, const RateLimits& limits, double s, int* places) noexcept;
  void move_in(double s, int axes) noexcept;
  bool look_at_axes(const RateLimits& limits, const CoursePoint& law) noexcept;
  bool look(const MotionState& motion, double jerk, int axes) noexcept;
  double fastest_ahead(const CourseView& view, const RateLimits& limits, int& places) noexcept;
  bool bent(double speed) const noexcept;
  bool goes_straight(int axes) const noexcept;
  Box box(std::size_t number, double fastest, double change) const noexcept;
  double jerk_left(const CourseView& view, const RateLimits& limits, double seconds,
                   const MotionState& motion, double sense) const noexcept;
  bool leave_acceleration(const CourseView& view, const RateLimits& limits, std::size_t number) noexcept;
  bool aim(const CourseView& view, const RateLimits& limits, const Box& box, int& places) noexcept;
  bool keeps_to(const CourseView& view, const RateLimits& limits, double t, int& places) noexcept;
  MotionState motion(double t) const noexcept;
  double next_place(double t, double step) const noexcept;

  CourseState from_;
  Here here_;
  MotionState now_;                 ///< there, in the direction of the motion
  double wanted_ = 0.0, v1_ = 0.0;  ///< rate at the end, >= 0, and about the speed there
  double forwards_ = 1.0;           ///< -1: backwards
  Profile profile_;                 ///< of the speed, seen in the direction of the motion
  Interval interval_;
  double begin_ = 0.0;           ///< of the interval, along the path from where the ramp begins
  double whole_ = 0.0;           ///< length of the interval
  double in_ = 0.0, way_ = 0.0;  ///< law time and way since the interval's begin
  double first_way_ = 0.0;       ///< from the interval's begin to where the ramp begins
  double t_ = 0.0;               ///< the last place
  double turns_ = 0.0;           ///< when the speed goes the other way, s; 0: it does not
  double fastest_ = 0.0;         ///< speed on the way
  RateState state_;
  bool ends_even_ = false;
  bool speeds_up_ = false;  ///< the law, at the last place
};

}  // namespace servogate::path
