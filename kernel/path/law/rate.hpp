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
class Verification {
 public:
  /// `beyond`: so much longer the rate at its end must hold before the last known stop.
  void begin(const RateChange& change, const LawTime& from, std::int64_t near_knot,
             double beyond = 0.0) noexcept;
  /// Counts the places down that it looks at, and stops at 0.
  Fit go(const CourseView& view, const RateLimits& limits, int& places) noexcept;
  const RateChange& change() const noexcept { return change_; }
  /// Number of the knot that ends the interval where it is.
  std::int64_t knot() const noexcept { return before_; }

 private:
  bool keeps_at_knots(const CourseView& view, std::int64_t to, const RateLimits& limits,
                      int& places) noexcept;
  RateChange change_;
  LawTime from_;
  std::int64_t before_ = 1;  // knot of the last place
  Interval interval_;
  double t_ = 0.0, last_ = 0.0, beyond_ = 0.0;
};

/// A change that ends at `at` in the rate r1 leaves `beyond` seconds at that rate, and a little more, before
/// the last stop that is known. real-time safe.
bool reaches_stop(const CourseView& view, const LawTime& at, double r1, double beyond) noexcept;

/// The early branch of a course: the speed along the path goes by constant jerk, by what the path's bend
/// leaves of the axes, whatever the law does there, and law time follows from the place. On the way the rate
/// may be up to kAbove beyond 1, or 2 % while the law speeds up: the law leaves a reserve that the ramp need
/// not leave. Everything here is real-time safe.
class PathRamp {
 public:
  static constexpr double kAbove = 6e-3;
  static constexpr std::size_t kPlans = 7;  ///< the fastest ones first
  /// The state of a motion on the course.
  struct From {
    LawTime time;
    std::int64_t knot = 1;
    double rate = 1.0, slope = 0.0;
  };
  /// Looks at the path from here on, once for all plans of the way to `target` times the law's speed, or to
  /// rest where that is the other way round. Counts `places` down by the knots that it looks at. False: the
  /// law rests, or the bend of the path takes nearly all of an axis.
  bool begin(const CourseView& view, const RateLimits& limits, const From& from, double target,
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

  From from_;
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

/// The course at rest at a law time; `near`: number of a knot near it. real-time safe.
CoursePoint point_at(const CourseView& view, const LawTime& t, std::int64_t near,
                     const RateLimits& limits) noexcept;

/// The shortest stop at a knot that is found near the one of a knot before. Bounded; for the planner.
StopHint find_stop(const CourseView& view, std::int64_t knot, const StopHint& before,
                   const RateLimits& limits);

/// Follows a course at a rate that changes. One cycle looks at no more than so many places of a change. While
/// the end of the course is not published, no change is entered that does not end before the last stop that
/// is, and there the motion stops. That is how it comes to where a broken course rests; what a hold has left
/// of the way there is gone from rest to rest.
class RateMotion {
 public:
  static constexpr int kMostPlaces = 1000;  // a cycle
  static constexpr int kTry = 6;            // that a try counts for by itself

  explicit RateMotion(const RateLimits& limits) noexcept : limits_(limits) {}
  /// At the start of a course, which rests there: any rate is at once.
  void begin(double rate) noexcept;
  /// One cycle on: `target` is the rate that is wanted, -1 to 1, or above where the path allows it: a rate
  /// above 1 is entered together with a way back to 1, and kept while that can be put off. A lower rate from
  /// 1 is settled in the cycle in which it is first wanted: what is not found at once begins as the next
  /// known stop, out of which the search goes on. False: the law time has come to the end of the course, to
  /// its start backwards, or to where it rests if it is broken.
  bool step(const CourseView& view, double target, double period) noexcept;
  CoursePoint point(const CourseView& view) const noexcept;
  /// -1 to 1, or above 1 where that is wanted; on a ramp up to 2 % beyond (PathRamp).
  double rate() const noexcept { return rate_; }
  const LawTime& time() const noexcept { return time_; }
  std::int64_t knot() const noexcept { return knot_; }
  /// A change is on its way, or settled: it begins in the knot of a stop that is known, a few ahead, or
  /// where the law has slowed down before a corner.
  bool changing() const noexcept { return active_ || settled_; }
  bool at_rest() const noexcept { return !active_ && rate_ == 0.0; }
  /// A change is on its way.
  bool underway() const noexcept { return active_; }
  /// It stops, or stands, because the course is not published any further.
  bool starving() const noexcept { return starving_; }
  double wanted() const noexcept {
    return !active_ ? rate_ : change_.way != 0.0 ? searched_for_ : change_.r1;
  }
  /// Looked at in the last cycle, and knots that were passed to plan a ramp.
  int places() const noexcept { return kMostPlaces - left_; }

 private:
  void advance(const CourseView& view, double period) noexcept;
  void advance_on_ramp(const CourseView& view, double period) noexcept;
  void start(const RateChange& change) noexcept;
  bool ramp(const CourseView& view, double target, double period) noexcept;
  bool slows_down(const CourseView& view) const noexcept;
  bool ramp_ahead(const CourseView& view, const StopHint& hint) noexcept;
  void forget_ramps(double target) noexcept;
  bool start_ramp_ahead(const CourseView& view, double period) noexcept;
  bool early(const CourseView& view, double target, const StopHint& hint, double period) noexcept;
  bool follow_ramp(const CourseView& view, double target, double period, int& places) noexcept;
  Fit enter(const CourseView& view, double target, double seconds, int power, double period) noexcept;
  bool stop_at(const CourseView& view, const StopHint& hint, double period) noexcept;
  double until(const CourseView& view, const StopHint& hint) const noexcept;
  bool stop_in_time(const CourseView& view, double target, double period) noexcept;
  bool try_known(const CourseView& view, const StopHint& hint, double period) noexcept;
  bool level_off(const CourseView& view, double period) noexcept;
  void search(const CourseView& view, double target, double period) noexcept;
  bool near_last_stop(const CourseView& view) const noexcept;
  void creep(const CourseView& view, double target) noexcept;
  bool rests_there(const CourseView& view) noexcept;
  void seek(const CourseView& view, double target, double period) noexcept;
  void surge(const CourseView& view, double target, double period) noexcept;
  void put_off(const CourseView& view, double period) noexcept;
  bool come_back(const CourseView& view, double period) noexcept;

  RateLimits limits_;
  LawTime time_;
  std::int64_t knot_ = 1;
  double rate_ = 1.0, slope_ = 0.0;
  RateChange change_;
  PathRamp ramp_;              ///< goes before the change
  bool ramp_tried_ = false;    ///< in the cycle before, in vain
  std::int64_t ramp_at_ = -1;  ///< the ramp begins in this knot
  struct Ahead {
    int cycles = 0, looked = 0, behind = 0;  ///< knots that were looked at, and those behind the slowest one
    std::int64_t knot = 1;
    double slowest = 0.0;
    bool slowing = false;  ///< the law, where the search began
    bool goes_on = false;  ///< in the next cycle
  };
  Ahead ahead_;        ///< the search for a knot where it may begin
  double into_ = 0.0;  ///< the ramp, or the change, s
  bool active_ = false, on_ramp_ = false, starving_ = false, settled_ = false, stuck_ = false;
  double searched_for_ = 2.0;  ///< target of the search
  double next_ = 0.0;          ///< length to try next
  double share_ = 1.0;         ///< of the target, where not enough is published for all of it
  int power_ = 3, left_ = kMostPlaces;
  Verification verification_;
  bool open_ = false;      ///< it goes on, at rest
  bool shorter_ = false;   ///< stops that are shorter than the known one were tried last
  bool levels_ = false;    ///< the change in progress leads to a constant rate, from which the search goes on
  bool creeping_ = false;  ///< next_ is the length of a way from rest to rest
  RateChange back_;        ///< from above 1
  double back_in_ = 0.0;   ///< s at the present rate until it begins
  int surges_tried_ = 0;
};

}  // namespace servogate::path
