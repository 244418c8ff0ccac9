// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/knot.hpp"

namespace servogate::path {

/// The rate of law time, its derivatives by time.
struct RateState {
  double rate = 1.0, slope = 0.0, bend = 0.0;
  double passed = 0.0;  ///< law time since the change began
};

/// The branch of a law over one clock: the rate at which law time passes, 1 as planned, 0 at rest, below 0
/// backwards. A change of the rate from (r0, slope0) to (r1, 0) in `seconds` goes late where it slows down,
/// as there is little room at full rate, and early where it speeds up. Everything here is real-time safe.
struct RateChange {
  double r0 = 1.0, slope0 = 0.0;
  double r1 = 0.0;
  double seconds = 1.0;  ///< > 0
  int power = 3;         ///< 2 or 3: how late

  /// `t` seconds from its start, >= 0; behind `seconds` r1 holds.
  RateState at(double t) const noexcept;
};

/// Knots of a run that the reader may look at. Numbers count from the start of the run; -2 and -1 are the
/// controls before it.
class CourseView {
 public:
  /// nullptr: not published, or no longer kept. real-time safe.
  virtual const Knot* knot(std::int64_t number) const noexcept = 0;
  /// Number of the knot that the run rests in; -1: not published yet. real-time safe.
  virtual std::int64_t end() const noexcept = 0;

 protected:
  ~CourseView() = default;
};

/// A place in a run that moves along with a law time.
class CoursePlace {
 public:
  explicit CoursePlace(const CourseView& view) noexcept : view_(&view) {}
  /// To a law time near the last one; false: it is not published. Before the start and behind the end of a
  /// run the course rests there.
  bool go(const LawTime& t) noexcept;
  /// Number of the knot that ends the interval.
  std::int64_t knot() const noexcept { return m_; }
  void set_knot(std::int64_t m) noexcept { m_ = m; }
  Vector position(const LawTime& t, int axes) const noexcept;

 private:
  bool stretch(const Knot* (&four)[4]) const noexcept;
  const CourseView* view_;
  std::int64_t m_ = 1;
};

/// What the set-points may not exceed while the rate changes.
struct RateLimits {
  int axes = 0;
  std::array<AxisLimits, kMaxAxes> limits{};
};

/// The way between two knots, made ready for many looks at its derivatives. real-time safe.
class Interval {
 public:
  /// The one that knot m ends; false: it is not published.
  bool take(const CourseView& view, std::int64_t m, int axes) noexcept;
  std::int64_t knot() const noexcept { return m_; }
  const LawTime& begin() const noexcept { return begin_; }
  double seconds() const noexcept { return tau_.seconds; }
  /// The limits hold `in` seconds of law time behind its begin at this rate; before and behind it the course
  /// rests.
  bool keeps(double in, const RateState& rate, const RateLimits& limits) const noexcept;

 private:
  std::int64_t m_ = 0;
  LawTime begin_;
  Quintic tau_{};
  std::array<double, kMaxAxes> slope_{}, bend_{}, third_{};  // of the spline, by axis
};

enum class Fit : std::uint8_t {
  fits,
  breaks,       ///< a limit, or the rate leaves -1 to 1
  unpublished,  ///< it would end behind what is known
  open,         ///< more places to look at than were allowed
};

/// Whether a change that begins at a law time keeps all limits to its end. Looks at a place each one or two
/// milliseconds, and at both sides of each knot that is passed. May go on in a later cycle where it was left.
class Verification {
 public:
  void begin(const RateChange& change, const LawTime& from, std::int64_t near_knot) noexcept;
  /// Counts the places down that it looks at, and stops at 0.
  Fit go(const CourseView& view, const RateLimits& limits, int& places) noexcept;
  const RateChange& change() const noexcept { return change_; }

 private:
  bool keeps_at_knots(const CourseView& view, std::int64_t to, const RateLimits& limits,
                      int& places) noexcept;
  RateChange change_;
  LawTime from_;
  std::int64_t before_ = 1;  // knot of the last place
  Interval interval_;
  double t_ = 0.0, last_ = 0.0;
};

/// A stop from full rate that has been verified from its knot on.
struct StopHint {
  double seconds = 0.3;
  int power = 3;
  std::int64_t knot = -1;  ///< -1: none was found
};

/// The shortest stop at a knot that is found near the one of a knot before. Bounded; for the planner.
StopHint find_stop(const CourseView& view, std::int64_t knot, const StopHint& before,
                   const RateLimits& limits);

/// Follows a run at a rate that changes. One cycle looks at no more than so many places of a change.
class RateMotion {
 public:
  static constexpr int kMostPlaces = 1200;  // a cycle

  explicit RateMotion(const RateLimits& limits) noexcept : limits_(limits) {}
  /// One cycle on: `target` is the rate that is wanted, -1 to 1; `hint`: the stop at the next knot that has
  /// one. False: the law time has come to the end of the run, or to its start backwards.
  bool step(const CourseView& view, double target, const StopHint& hint, double period) noexcept;
  Vector position(const CourseView& view) const noexcept;
  double rate() const noexcept { return rate_; }
  const LawTime& time() const noexcept { return time_; }
  std::int64_t knot() const noexcept { return knot_; }
  /// A change is on its way.
  bool changing() const noexcept { return active_; }
  double wanted() const noexcept { return active_ ? change_.r1 : rate_; }
  /// Looked at in the last cycle.
  int places() const noexcept { return kMostPlaces - left_; }

 private:
  void advance(double period) noexcept;
  void start(const RateChange& change) noexcept;
  Fit enter(const CourseView& view, double target, double seconds, int power) noexcept;
  bool stop_at(const CourseView& view, const StopHint& hint, double period) noexcept;
  void search(const CourseView& view, double target, const StopHint& hint) noexcept;

  RateLimits limits_;
  LawTime time_;
  std::int64_t knot_ = 1;
  double rate_ = 1.0;
  RateChange change_;
  double into_ = 0.0;  ///< the change, s
  bool active_ = false;
  double searched_for_ = 2.0;  ///< target of the search
  double next_ = 0.0;          ///< length to try next
  int power_ = 3, left_ = kMostPlaces;
  Verification verification_;
  bool open_ = false;  ///< it goes on, at rest
};

}  // namespace servogate::path
