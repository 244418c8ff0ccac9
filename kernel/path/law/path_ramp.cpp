// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "kernel/path/law/path_ramp.hpp"
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {
namespace {

constexpr double kPlace = 0.001;  // s between places; in ramps of half a second twice as far, of one thrice
constexpr double kAside = 0.9;    // of an axis' acceleration: the bend leaves too little
constexpr double kBent = 0.05;    // of it: the bend leaves less than all of the jerk
constexpr double kTurned = 0.4;   // cosine
constexpr double kMostOfAcceleration = 0.9996;
constexpr int kSolve = 1;              // looks that take as long as to find the place
constexpr double kSpeedsUp = 0.02;     // of it
constexpr double kAboveRising = 0.02;  // of the rate, while the law speeds up to a feed
constexpr double kSameRate = 1e-10;
constexpr double kSlow = 1e-3;         // mm/s of the law: it rests, or nearly
constexpr double kSame = 1e-12;        // mm
constexpr double kLengthKnown = 1e-8;  // mm
constexpr double kBesideBreak = 1e-9;  // s from where the jerk changes
constexpr double kBesideKnot = 2e-5;   // s
constexpr int kRounds = 12;            // of a place's search

/// By shares of what the axes can in the direction of the path: what a hardly bent path takes is jerk.
constexpr double kStraight[] = {0.9995, 0.98, 0.96, 0.9, 0.8, 0.6, 0.4};
/// By shares of what is reckoned to be left along a bent path.
constexpr double kBentShares[] = {1.1, 1.0, 0.9, 0.8, 0.65, 0.5, 0.35};
/// And of the jerk that is left where the ramp begins, to leave a change of speed.
constexpr double kFirst[] = {0.995, 0.985, 0.97, 0.95, 0.9, 0.8, 0.6};

static_assert(std::size(kStraight) == PathRamp::kPlans && std::size(kBentShares) == PathRamp::kPlans &&
              std::size(kFirst) == PathRamp::kPlans);

double dot(const Vector& a, const Vector& b, int axes) {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) sum += a[i] * b[i];
  return sum;
}

/// The rate that makes a motion of the law's; false: that rests.
bool rate_of(const Interval::Pace& law, const MotionState& motion, double jerk, RateState& state) {
  if (!(law.v > kSlow)) return false;
  const double r = motion.v / law.v, slope = (motion.a - law.a * r * r) / law.v;
  state = {r, slope, (jerk - law.j * r * r * r - 3.0 * law.a * r * slope) / law.v, 0.0};
  return true;
}

/// The seconds of a change of speed from rest to rest of acceleration.
double time_of(double change, const Box& box) {
  const double a = std::min(box.acceleration, std::sqrt(box.jerk * change));
  return change / a + a / box.jerk;
}

/// What a bend leaves along the path for a change of speed, in every direction, by which that takes the least
/// time: the jerk aside is at its greatest at the end of the first jerk. No jerk: it leaves next to nothing.
Box left_by_bend(const Box& any, double v, double curve, double change) {
  constexpr int kSteps = 12, kTurns = 4;
  const double aside = curve * v * v, steady = curve * aside * v, least_jerk = 0.1 * any.jerk;
  Box best{};
  double least = std::numeric_limits<double>::infinity();
  for (int n = 1; n <= kSteps; ++n) {
    Box box{any.velocity, any.acceleration * n / kSteps, any.jerk};
    if (std::hypot(box.acceleration, aside) > any.acceleration) break;
    for (int turn = 0; turn < kTurns && box.jerk > least_jerk; ++turn) {
      const double a = std::min(box.acceleration, std::sqrt(box.jerk * change));
      const double across = 3.0 * curve * std::max(0.0, v - 0.5 * a * a / box.jerk) * a;
      box.jerk = std::sqrt(std::max(0.0, any.jerk * any.jerk - across * across)) - steady;
    }
    if (!(box.jerk > least_jerk)) break;
    if (const double time = time_of(change, box); time < least) {
      least = time;
      best = box;
    }
  }
  return best;
}

}  // namespace

LawTime PathRamp::time() const noexcept { return interval_.begin().plus(in_); }

/// In the direction in which law time goes forwards.
MotionState PathRamp::motion(double t) const noexcept {
  const MotionState m = profile_.at(t);
  return {forwards_ * m.s, forwards_ * m.v, forwards_ * m.a};
}

/// Not where the path turns so sharply that its length is not known well enough.
bool PathRamp::take(const CourseView& view, std::int64_t m, const RateLimits& limits) noexcept {
  if (!interval_.take(view, m, limits)) return false;
  const double end = interval_.seconds(), middle = 0.5 * end;
  whole_ = interval_.length(0.0, end, limits.axes);
  if (interval_.even()) return true;
  const double halves =
      interval_.length(0.0, middle, limits.axes) + interval_.length(middle, end, limits.axes);
  return std::abs(halves - whole_) <= kLengthKnown;
}

bool PathRamp::step_on(const CourseView& view, const RateLimits& limits, bool forwards) noexcept {
  const std::int64_t before = begin_of(view, interval_.knot());
  if (forwards ? interval_.knot() == view.end() : before <= 0) return false;
  const double end = begin_ + whole_;
  if (!take(view, forwards ? next_of(view, interval_.knot()) : before, limits)) return false;
  begin_ = forwards ? end : begin_ - whole_;
  in_ = forwards ? 0.0 : interval_.seconds();
  way_ = forwards ? 0.0 : whole_;
  return true;
}

/// To a place in the interval, by its length from the begin: what is not known of that is no step at a knot.
void PathRamp::move_in(double s, int axes) noexcept {
  for (int n = 0; n < kRounds; ++n) {
    const double missing = s - begin_ - way_;
    if (std::abs(missing) <= kSame) return;
    const double v = interval_.speed(in_, axes);
    const double to = std::clamp(in_ + missing / std::max(v, kSlow), 0.0, interval_.seconds());
    if (to == in_) return;
    way_ = interval_.length(0.0, to, axes);
    in_ = to;
  }
}

/// The interval where the place lies, and where in it. With `places`, to plan: they are counted down by the
/// knots that are passed.
bool PathRamp::move_to(const CourseView& view, const RateLimits& limits, double s, int* places) noexcept {
  bool on = false, back = false;
  while ((!back && s > begin_ + whole_) || (!on && s < begin_)) {
    const bool forwards = s > begin_ + whole_;
    (forwards ? on : back) = true;
    if (!step_on(view, limits, forwards)) return false;
    if (places != nullptr && --*places <= 0) return false;
  }
  move_in(s, limits.axes);
  return true;
}

/// The rate that makes this motion where it is; false: the law rests there.
bool PathRamp::look(const MotionState& motion, double jerk, int axes) noexcept {
  const Interval::Pace law = interval_.pace(in_, axes);
  speeds_up_ = forwards_ * law.a > kSpeedsUp * here_.any.acceleration;
  return rate_of(law, motion, jerk, state_);
}

bool PathRamp::bent(double speed) const noexcept {
  return here_.curve * speed * speed > kBent * here_.any.acceleration;
}

/// The path goes on, where it is looked at, about as it goes at the ramp's begin.
bool PathRamp::goes_straight(int axes) const noexcept {
  const Vector v = interval_.at(in_, 1.0, 0.0, axes).v;
  return dot(v, here_.along, axes) > kTurned * norm(v, axes) * norm(here_.along, axes);
}

/// The law's greatest speed in the direction of the motion, up to where it is constant or as far as a change
/// of speed may go.
double PathRamp::fastest_ahead(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  constexpr int kMostKnots = 160;
  constexpr double kFar = 1.5;
  double most = interval_.speed(in_, limits.axes);
  const double far = kFar * most * time_of(most, here_.any);
  for (int n = 0; n < kMostKnots && places > 0; ++n, --places) {
    most = std::max(most, interval_.speed(forwards_ > 0.0 ? interval_.seconds() : 0.0, limits.axes));
    if (interval_.even() || std::abs(begin_) > far || !step_on(view, limits, forwards_ > 0.0)) break;
  }
  return most;
}

Box PathRamp::box(std::size_t number, double fastest, double change) const noexcept {
  if (bent(fastest)) {
    Box box = left_by_bend(here_.any, fastest, here_.curve, change);
    box.acceleration *= std::min(1.0, kBentShares[number]);
    box.jerk *= kBentShares[number];
    return box;
  }
  const double share = kStraight[number];
  Box box = here_.straight;
  box.acceleration *= std::min(kMostOfAcceleration, 1.0 - 0.25 * (1.0 - share));
  box.jerk *= share;
  return box;
}

/// What the axes can where the ramp begins. False: the law rests there, or the bend takes nearly all of them.
bool PathRamp::look_at_axes(const RateLimits& limits, const CoursePoint& law) noexcept {
  constexpr double kMoves = 1e-3, kMost = std::numeric_limits<double>::infinity();
  const double v = norm(law.v, limits.axes), a = norm(law.a, limits.axes);
  if (!(v > kSlow)) return false;
  const double along = dot(law.v, law.a, limits.axes) / v;
  here_ = {{kMost, kMost, kMost}, {kMost, kMost, kMost}, law.v};
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const AxisLimits& axis = limits.limits[i];
    const double part = std::abs(law.v[i]) / v, aside = std::abs(law.a[i] - along * law.v[i] / v);
    if (!(aside * from_.rate * from_.rate <= kAside * axis.acceleration)) return false;
    if (part > 0.0) {
      Box& box = here_.straight;
      box = {std::min(box.velocity, axis.velocity / part),
             std::min(box.acceleration, axis.acceleration / part), std::min(box.jerk, axis.jerk / part)};
    }
    if (part <= kMoves && std::abs(law.a[i]) <= kMoves * a) continue;
    Box& box = here_.any;
    box = {std::min(box.velocity, axis.velocity), std::min(box.acceleration, axis.acceleration),
           std::min(box.jerk, axis.jerk)};
  }
  here_.curve = std::sqrt(std::max(0.0, a * a - along * along)) / (v * v);
  return true;
}

bool PathRamp::begin(const CourseView& view, const RateLimits& limits, const CourseState& from, double target,
                     int& places) noexcept {
  from_ = from;
  forwards_ = from.rate < 0.0 || (from.rate == 0.0 && target < 0.0) ? -1.0 : 1.0;
  first_way_ = 0.0;
  if (!rewind(view, limits) || !(in_ >= 0.0 && in_ <= interval_.seconds())) return false;
  if (!look_at_axes(limits, interval_.at(in_, 1.0, 0.0, limits.axes))) return false;
  way_ = first_way_ = interval_.length(0.0, in_, limits.axes);
  begin_ = -first_way_;
  const Interval::Pace law = interval_.pace(in_, limits.axes);
  now_ = {0.0, forwards_ * from.rate * law.v,
          forwards_ * (law.a * from.rate * from.rate + law.v * from.slope)};
  wanted_ = std::max(0.0, forwards_ * target);
  v1_ = wanted_ > 0.0 ? wanted_ * fastest_ahead(view, limits, places) : 0.0;
  return now_.v >= 0.0 && (v1_ > 0.0 || wanted_ == 0.0);
}

/// The jerk that the axes leave to slow down (sense -1) or to speed up (1) some seconds behind the start, at
/// that motion, where the law would be.
double PathRamp::jerk_left(const CourseView& view, const RateLimits& limits, double seconds,
                           const MotionState& motion, double sense) const noexcept {
  constexpr double kAcross = 1e-6;
  CoursePlace place(view);
  place.set_knot(from_.knot);
  const LawTime at = from_.time.plus(from_.rate * seconds);
  Interval there;
  if (!place.go(at) || !there.take(view, place.knot(), limits)) return 0.0;
  const double in = std::clamp(at.since(there.begin()), 0.0, there.seconds());
  RateState state;
  if (!rate_of(there.pace(in, limits.axes), motion, 0.0, state)) return 0.0;
  const Vector steady = there.jerk(in, state, limits.axes), v = there.at(in, 1.0, 0.0, limits.axes).v;
  const double speed = forwards_ * norm(v, limits.axes);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const double part = sense * v[i] / speed, most = limits.limits[i].jerk;
    if (std::abs(part) > kAcross)
      least = std::min(least, (most - std::copysign(steady[i], part * steady[i])) / std::abs(part));
  }
  return least;
}

/// First what is left of an acceleration the other way round, by nearly all of the jerk that there is for it,
/// which gets less and more on a bent path.
bool PathRamp::leave_acceleration(const CourseView& view, const RateLimits& limits,
                                  std::size_t number) noexcept {
  constexpr int kParts = 3;
  constexpr double kLeast = 0.3;  // of the jerk in any direction; by less the law's own way is better
  profile_.start(now_);
  const double any = here_.any.jerk, natural = now_.v + 0.5 * now_.a * std::abs(now_.a) / any;
  if (!(now_.a * (v1_ - natural) < 0.0)) return natural >= 0.0;
  const double sense = now_.a > 0.0 ? -1.0 : 1.0, part = std::abs(now_.a) / kParts;
  const double share = bent(now_.v) ? kFirst[number] : kStraight[number];
  for (int n = kParts; n > 0; --n) {
    const auto left = [&] {
      const MotionState& m = profile_.end();
      return jerk_left(view, limits, profile_.duration(), {0.0, forwards_ * m.v, forwards_ * m.a}, sense);
    };
    const Profile before = profile_;
    const double here = left();
    if (!(here > 0.0)) return false;
    profile_.add(part / here, sense * here);
    const double jerk = share * std::min(here, left());
    profile_ = before;
    if (!(jerk > kLeast * any)) return false;
    profile_.add(part / jerk, sense * jerk);
  }
  profile_.finish_at({profile_.end().s, profile_.end().v, 0.0});
  return profile_.end().v >= 0.0;
}

/// The profile to the rate that is wanted where it ends.
bool PathRamp::aim(const CourseView& view, const RateLimits& limits, const Box& box, int& places) noexcept {
  constexpr int kTurns = 3;
  const Profile start = profile_;
  double v1 = v1_;
  for (int n = 0; n < kTurns; ++n) {
    profile_ = start;
    add_ramp(profile_, start.end().v, start.end().a, v1, box);
    const MotionState end = motion(profile_.duration());
    if (!move_to(view, limits, end.s, &places) || !look(end, 0.0, limits.axes)) return false;
    if (!bent(fastest_) && !goes_straight(limits.axes)) return false;  // round a corner
    const double off = wanted_ - std::abs(state_.rate);
    ends_even_ = interval_.even() && std::abs(off) <= kSameRate;
    if (wanted_ == 0.0 || std::abs(off) <= kSameRate) break;
    if (n + 1 < kTurns) v1 *= wanted_ / std::abs(state_.rate);
  }
  return true;
}

bool PathRamp::plan(const CourseView& view, const RateLimits& limits, std::size_t number,
                    int& places) noexcept {
  if (!rewind(view, limits) || !leave_acceleration(view, limits, number)) return false;
  const MotionState& then = profile_.end();
  fastest_ = std::max({now_.v, then.v, v1_});
  const Box limit = box(number, fastest_, std::abs(v1_ - then.v));
  if (!(limit.jerk > 0.0)) return false;
  if (!(then.v + 0.5 * then.a * std::abs(then.a) / limit.jerk >= 0.0)) return false;  // it would turn round
  if (!aim(view, limits, limit, places)) return false;
  const double jerk = profile_.jerk(0.0);
  turns_ = jerk * now_.a < 0.0 ? -now_.a / jerk : 0.0;
  fastest_ = std::max(fastest_, profile_.end().v);
  return rewind(view, limits) && profile_.duration() > 0.0;
}

bool PathRamp::rewind(const CourseView& view, const RateLimits& limits) noexcept {
  if (!take(view, from_.knot, limits)) return false;
  in_ = from_.time.since(interval_.begin());
  way_ = first_way_;
  begin_ = -first_way_;
  t_ = 0.0;
  return true;
}

bool PathRamp::go(const CourseView& view, const RateLimits& limits, double t) noexcept {
  if (!move_to(view, limits, motion(t).s, nullptr)) return false;
  t_ = t;
  return look(motion(t), forwards_ * profile_.jerk(t), limits.axes);
}

/// Goes on to a place, by both sides of the knots between.
bool PathRamp::keeps_to(const CourseView& view, const RateLimits& limits, double t, int& places) noexcept {
  const double s0 = motion(t_).s, s1 = motion(t).s;
  const bool forwards = s1 > s0;
  const double last = t_;
  const auto keeps_at = [&](double time) {
    --places;
    return look(motion(time), forwards_ * profile_.jerk(time), limits.axes) &&
           interval_.keeps(in_, state_, limits);
  };
  while (forwards ? s1 > begin_ + whole_ : s1 < begin_) {
    const double knot = forwards ? begin_ + whole_ : begin_;
    const double time = last + std::clamp((knot - s0) / (s1 - s0), 0.0, 1.0) * (t - last);
    in_ = forwards ? interval_.seconds() : 0.0;
    if (!keeps_at(time) || places <= 0 || !step_on(view, limits, forwards) || !keeps_at(time)) return false;
    t_ = time;
  }
  if (t_ > last && t - t_ < kBesideKnot && t < profile_.duration()) return true;
  move_in(s1, limits.axes);
  places -= kSolve;
  t_ = t;
  return keeps_at(t);
}

/// Where it is looked at next, at the latest behind `step`: both sides of where the jerk changes, and where
/// the speed is at its greatest or least. While the law's speed is constant along a line nothing else is
/// needed: there the acceleration goes straight from one to the next.
double PathRamp::next_place(double t, double step) const noexcept {
  constexpr double kNear = 1.2;  // steps from a knot
  if (interval_.even() && fastest_ > 0.0) {
    const double s = motion(t).s;
    const double left = forwards_ > 0.0 ? begin_ + whole_ - s : s - begin_;
    step = std::max(step, left / fastest_);
  }
  if (!interval_.even()) {
    const MotionState now = motion(t);
    const double left = forwards_ > 0.0 ? begin_ + whole_ - now.s : now.s - begin_,
                 in = left / std::abs(now.v);
    if (in < kNear * step)
      step = std::max(0.0, in) + 0.5 * kBesideKnot;
    else if (in < 2.0 * step)
      step = 0.5 * in;
  }
  double to = std::min(t + step, profile_.duration());
  if (turns_ > t) to = std::min(to, turns_);
  for (int n = 1; n < profile_.size(); ++n)
    for (const double side : {-kBesideBreak, kBesideBreak})
      if (profile_.begins(n) + side > t) to = std::min(to, profile_.begins(n) + side);
  return to;
}

Fit PathRamp::verify(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  const double whole = profile_.duration();
  const double step = (whole > 1.0 ? 3.0 : whole > 0.5 ? 2.0 : 1.0) * kPlace;
  double most = 1.0;
  for (double t = 0.0;; t = next_place(t_, step)) {
    if (places <= 0) return Fit::open;
    if (!keeps_to(view, limits, t, places)) return Fit::breaks;
    if (!(profile_.at(t_).v >= -kSame)) return Fit::breaks;
    const double rate = std::abs(state_.rate);
    // Out of speeding up above full rate it goes on up for a while.
    if (t == 0.0 && rate > 1.0) most = rate * fastest_ / profile_.at(0.0).v;
    if (!(rate <= most + (speeds_up_ ? kAboveRising : kAbove))) return Fit::breaks;
    if (t_ >= whole) return Fit::fits;
  }
}

}  // namespace servogate::path
