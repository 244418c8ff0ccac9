// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/law/knot.hpp"
#include "kernel/path/law/s_curve.hpp"

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
  /// Not 0: instead of all that, from rest to rest over so much law time, backwards if below 0.
  double way = 0.0;
  static constexpr double kShortest = 0.04, kLongest = 6.0, kLonger = 1.18;  // s; from length to length

  /// `t` seconds from its start, >= 0; behind `seconds` r1 holds.
  RateState at(double t) const noexcept;
};

/// A stop from full rate that has been verified from its knot on.
struct StopHint {
  double seconds = 0.3;
  int power = 3;
  std::int64_t knot = -1;  ///< -1: none was found
};

/// Knots of a course from rest to rest that the reader may look at. Numbers count from its first knot; -2 and
/// -1 are the controls before it.
class CourseView {
 public:
  /// nullptr: not published, or no longer kept. real-time safe.
  virtual const Knot* knot(std::int64_t number) const noexcept = 0;
  /// Number of the knot that the course rests in; -1: not published yet. real-time safe.
  virtual std::int64_t end() const noexcept = 0;
  /// While the end is not published: the last stop that is. Behind its knot the motion may not go without it.
  virtual StopHint guard() const noexcept { return {}; }
  /// The first stop at or behind a knot, or the last one before. real-time safe.
  virtual StopHint stop_near(std::int64_t /*knot*/) const noexcept { return {}; }
  /// Where a course rests that does not come to its end: its last stop leads there; nullptr: it is none.
  /// real-time safe.
  virtual const LawTime* rests_at() const noexcept { return nullptr; }

 protected:
  ~CourseView() = default;
};

/// Number of the knot where the interval begins that knot `m` ends. real-time safe.
std::int64_t begin_of(const CourseView& view, std::int64_t m) noexcept;
/// Number of the knot that ends the interval behind knot `m`; it need not be published. real-time safe.
std::int64_t next_of(const CourseView& view, std::int64_t m) noexcept;

/// A place in a course that moves along with a law time.
class CoursePlace {
 public:
  explicit CoursePlace(const CourseView& view) noexcept : view_(&view) {}
  /// To a law time near the last one; false: it is not published. Before the start and behind the end of a
  /// course it rests there.
  bool go(const LawTime& t) noexcept;
  /// Number of the knot that ends the interval.
  std::int64_t knot() const noexcept { return m_; }
  void set_knot(std::int64_t m) noexcept { m_ = m; }

 private:
  const CourseView* view_;
  std::int64_t m_ = 1;
};

/// The state of a motion on a course.
struct CourseState {
  LawTime time;
  std::int64_t knot = 1;  ///< ends the interval where it is
  double rate = 1.0, slope = 0.0;
};

/// What the set-points may not exceed while the rate changes.
struct RateLimits {
  int axes = 0;
  std::array<AxisLimits, kMaxAxes> limits{};
  const Transformation* transformation = &identity();  ///< from the knots' coordinates to the axes
};

/// Where the motion is, and how it goes on.
struct CoursePoint {
  Vector x{}, v{}, a{};  ///< of the axes
  double place = 0.0;    ///< path parameter
  double speed = 0.0;    ///< of the path parameter
};

/// The way between two knots, made ready for many looks at its derivatives. real-time safe.
class Interval {
 public:
  /// The one that knot m ends; false: it is not published.
  bool take(const CourseView& view, std::int64_t m, const RateLimits& limits) noexcept;
  std::int64_t knot() const noexcept { return m_; }
  const LawTime& begin() const noexcept { return begin_; }
  double seconds() const noexcept { return tau_.seconds; }
  /// The limits hold `in` seconds of law time behind its begin at this rate; before and behind it the course
  /// rests.
  bool keeps(double in, const RateState& rate, const RateLimits& limits) const noexcept;
  /// The least and the largest second derivative of the rate that keep the jerk of all axes there; false:
  /// there is none, or velocity or acceleration exceed `share` of the limits.
  bool bends(double in, double rate, double slope, const RateLimits& limits, double share, double& least,
             double& largest) const noexcept;
  /// The course `in` seconds behind its begin, with velocity and acceleration at this rate.
  CoursePoint at(double in, double rate, double slope, int axes) const noexcept;
  /// The speed along the path, in the measure of the axes, and its derivatives by law time.
  struct Pace {
    double v, a, j;
  };
  Pace pace(double in, int axes) const noexcept;
  /// Third derivative by time, at this rate.
  Vector jerk(double in, const RateState& rate, int axes) const noexcept;
  /// As pace().v.
  double speed(double in, int axes) const noexcept;
  /// The way along the path between two law times, by Gauss' rule of three places; below 0 backwards.
  double length(double from, double to, int axes) const noexcept;
  /// A straight at constant speed.
  bool even() const noexcept { return even_; }

 private:
  void turn(const RateLimits& limits) noexcept;
  std::int64_t m_ = 0;
  LawTime begin_;
  Quintic tau_{};
  bool even_ = false;
  double place_ = 0.0, way_ = 0.0;
  Vector start_{}, slope_{}, bend_{}, third_{};  // of the spline at its begin, on the axes
};

enum class Fit : std::uint8_t {
  fits,
  breaks,       ///< a limit, or the rate leaves -1 to 1, or what it changes between
  unpublished,  ///< it would end behind what is known
  open,         ///< more places to look at than were allowed
};

/// Whether a change that begins at a law time keeps all limits to its end. Looks at a place each one or two
/// milliseconds, and at both sides of each knot that is passed. May go on in a later cycle where it was left.
/// Change: RateChange, or what else gives a rate over time from r0 to r1 in `seconds`.
template <class Change>
class VerificationOf {
 public:
  /// `beyond`: so much longer the rate at its end must hold before the last known stop.
  void begin(const Change& change, const LawTime& from, std::int64_t near_knot, double beyond = 0.0) noexcept;
  /// Counts the places down that it looks at, and stops at 0.
  Fit go(const CourseView& view, const RateLimits& limits, int& places) noexcept;
  const Change& change() const noexcept { return change_; }
  const LawTime& from() const noexcept { return from_; }
  /// Share of the change that it has come through.
  double reached() const noexcept { return t_ / change_.seconds; }
  /// Number of the knot that ends the interval where it is.
  std::int64_t knot() const noexcept { return before_; }

 private:
  bool keeps_at_knots(const CourseView& view, std::int64_t to, const RateLimits& limits,
                      int& places) noexcept;
  Change change_;
  LawTime from_;
  std::int64_t before_ = 1;  // knot of the last place
  Interval interval_;
  double t_ = 0.0, last_ = 0.0, beyond_ = 0.0;
};
using Verification = VerificationOf<RateChange>;

/// Looks at every eighth of the places of a Verification, and counts them down: false where one of them
/// breaks a limit, which most changes that are too short do. real-time safe.
bool may_keep(const CourseView& view, const RateChange& change, const LawTime& from, std::int64_t near,
              const RateLimits& limits, int& places) noexcept;

/// A change that ends at `at` in the rate r1 leaves `beyond` seconds at that rate, and a little more, before
/// the last stop that is known. real-time safe.
bool reaches_stop(const CourseView& view, const LawTime& at, double r1, double beyond) noexcept;

/// The course at rest at a law time; `near`: number of a knot near it. real-time safe.
CoursePoint point_at(const CourseView& view, const LawTime& t, std::int64_t near,
                     const RateLimits& limits) noexcept;

/// The shortest stop at a knot that is found near the one of a knot before. Bounded; for the planner.
StopHint find_stop(const CourseView& view, std::int64_t knot, const StopHint& before,
                   const RateLimits& limits);

}  // namespace servogate::path
