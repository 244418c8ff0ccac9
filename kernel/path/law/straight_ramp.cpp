// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/law/rate.hpp"
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {
namespace {

constexpr double kPlace = 0.001;  // s between places; in ramps of half a second twice as far, of one thrice
constexpr double kBent = 0.8;     // of a direction: no straight, nor nearly one
constexpr double kAside = 0.6;    // of an axis' acceleration: nor one
constexpr int kSolve = 1;         // looks that take as long as to find the place
constexpr double kSameRate = 1e-10;
constexpr double kSlow = 1e-3;         // mm/s of the law: it rests, or nearly
constexpr double kSame = 1e-12;        // mm
constexpr double kBesideBreak = 1e-9;  // s from where the jerk changes
constexpr int kRounds = 60;            // of a place's search

double dot(const Vector& a, const Vector& b, int axes) {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) sum += a[i] * b[i];
  return sum;
}

/// What the axes allow in a direction: across it the path is hardly bent, and what that takes is jerk.
Box box_along(const Vector& direction, const RateLimits& limits, double share) {
  Box box{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const double part = std::abs(direction[i]);
    if (part == 0.0) continue;
    box.velocity = std::min(box.velocity, limits.limits[i].velocity / part);
    box.acceleration =
        std::min(box.acceleration, (1.0 - 0.25 * (1.0 - share)) * limits.limits[i].acceleration / part);
    box.jerk = std::min(box.jerk, share * limits.limits[i].jerk / part);
  }
  return box;
}

/// The share of the parameter's time at which the place is `s`.
double solve(const Interval::Along& along, const Quintic& tau, double s, double guess) {
  double low = 0.0, high = 1.0, z = std::clamp(guess, 0.0, 1.0);
  for (int n = 0; n < kRounds; ++n) {
    const double f = tau.at(z), missing = s - along.at(f);
    if (std::abs(missing) <= kSame || high - low < 1e-16) break;
    (missing > 0.0 ? low : high) = z;
    const double slope = (along.slope + f * (along.bend + 0.5 * f * along.third)) * tau.d1(z) * tau.seconds;
    const double next = z + missing / slope;
    if (next == z) break;
    z = next > low && next < high ? next : 0.5 * (low + high);
  }
  return z;
}

}  // namespace

LawTime StraightRamp::time() const noexcept { return interval_.begin().plus(in_); }

/// In the direction in which law time goes forwards.
MotionState StraightRamp::motion(double t) const noexcept {
  const MotionState m = profile_.at(t);
  return {origin_ + forwards_ * m.s, forwards_ * m.v, forwards_ * m.a};
}

bool StraightRamp::take(const CourseView& view, std::int64_t m, const RateLimits& limits) noexcept {
  if (!interval_.take(view, m, limits)) return false;
  take_along(limits.axes);
  return true;
}

bool StraightRamp::step_on(const CourseView& view, const RateLimits& limits, bool forwards) noexcept {
  const std::int64_t begin = begin_of(view, interval_.knot());
  if (forwards ? interval_.knot() == view.end() : begin <= 0) return false;
  return take(view, forwards ? next_of(view, interval_.knot()) : begin, limits);
}

/// The interval where the place lies, and where in it. With `places`, to plan: they are counted down by the
/// knots that are passed, and the way there has to be straight.
bool StraightRamp::move_to(const CourseView& view, const RateLimits& limits, double s, int* places) noexcept {
  const std::int64_t from = interval_.knot();
  bool on = false, back = false;
  while ((!back && s > along_.at(1.0)) || (!on && s < along_.at(0.0))) {
    const bool forwards = s > along_.at(1.0);
    (forwards ? on : back) = true;
    if (!step_on(view, limits, forwards)) return false;
    if (places == nullptr) continue;
    if (--*places <= 0 || !straight_at(forwards ? 0.0 : interval_.seconds(), limits)) return false;
  }
  const Quintic& tau = interval_.tau();
  const double guess = interval_.knot() == from ? in_ / tau.seconds : 0.5;
  in_ = solve(along_, tau, s, guess) * tau.seconds;
  return true;
}

/// The rate that makes this motion where it is; false: the law rests there.
bool StraightRamp::look(const MotionState& motion, double jerk) noexcept {
  const Quintic& tau = interval_.tau();
  const double z = in_ / tau.seconds, f = tau.at(z), w = tau.d1(z), w2 = tau.d2(z), w3 = tau.d3(z);
  const double y1 = along_.slope + f * (along_.bend + 0.5 * f * along_.third);
  const double y2 = along_.bend + f * along_.third, y3 = along_.third;
  const double v = y1 * w, a = y2 * w * w + y1 * w2, j = y3 * w * w * w + 3.0 * y2 * w * w2 + y1 * w3;
  if (!(v > kSlow)) return false;
  const double r = motion.v / v, slope = (motion.a - a * r * r) / v;
  state_ = {r, slope, (jerk - j * r * r * r - 3.0 * a * r * slope) / v, 0.0};
  return true;
}

/// The law's greatest speed in the direction of the motion, up to where it is constant or the path bends.
double StraightRamp::fastest_ahead(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  constexpr int kMostKnots = 160;
  const Interval here = interval_;
  double most = 0.0;
  for (int n = 0; n < kMostKnots && places > 0; ++n, --places) {
    const double z = forwards_ > 0.0 ? 1.0 : 0.0;
    most =
        std::max(most, (along_.slope + z * (along_.bend + 0.5 * z * along_.third)) * interval_.tau().d1(z));
    if (interval_.even() || !straight_at(z * interval_.seconds(), limits)) break;
    if (!step_on(view, limits, forwards_ > 0.0)) break;
  }
  interval_ = here;
  take_along(limits.axes);
  return most;
}

bool StraightRamp::straight_at(double in, const RateLimits& limits) const noexcept {
  const Vector v = interval_.at(in, 1.0, 0.0, limits.axes).v;
  const double along = dot(v, direction_, limits.axes);
  double aside = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const double d = v[i] - along * direction_[i];
    aside += d * d;
  }
  return along > kSlow && std::sqrt(aside) <= kBent * along;
}

/// Takes direction and place; `along` is the law's motion in that direction. False: the law rests, or the
/// bend takes much of an axis.
bool StraightRamp::begins_straight(const RateLimits& limits, const CoursePoint& law, double rate,
                                   MotionState& along) noexcept {
  along.v = norm(law.v, limits.axes);
  if (!(along.v > kSlow)) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) direction_[i] = law.v[i] / along.v;
  along.a = dot(direction_, law.a, limits.axes);
  origin_ = along.s = dot(direction_, law.x, limits.axes);
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const double aside = (law.a[i] - along.a * direction_[i]) * rate * rate;
    if (!(std::abs(aside) <= kAside * limits.limits[i].acceleration)) return false;
  }
  return true;
}

/// The profile to `wanted` times the law's speed where it ends.
bool StraightRamp::aim(const CourseView& view, const RateLimits& limits, const MotionState& now,
                       double wanted, const Box& box, int& places) noexcept {
  constexpr int kRounds = 3;
  double v1 = wanted > 0.0 ? wanted * fastest_ahead(view, limits, places) : 0.0;
  if (wanted > 0.0 && !(v1 > 0.0)) return false;
  for (int n = 0; n < kRounds; ++n) {
    profile_.start(now);
    add_ramp(profile_, now.v, now.a, v1, box);
    const MotionState end = motion(profile_.duration());
    if (!move_to(view, limits, end.s, &places) || !straight_at(in_, limits) || !look(end, 0.0)) return false;
    const double off = wanted - std::abs(state_.rate);
    ends_even_ = interval_.even() && std::abs(off) <= kSameRate;
    if (wanted == 0.0 || std::abs(off) <= kSameRate) break;
    if (n + 1 < kRounds) v1 *= wanted / std::abs(state_.rate);
  }
  return true;
}

bool StraightRamp::plan(const CourseView& view, const RateLimits& limits, const From& from, double target,
                        double share, int& places) noexcept {
  forwards_ = from.rate < 0.0 || (from.rate == 0.0 && target < 0.0) ? -1.0 : 1.0;
  if (!interval_.take(view, from.knot, limits)) return false;
  in_ = from.time.since(interval_.begin());
  if (!(in_ >= 0.0 && in_ <= interval_.seconds())) return false;
  MotionState law{};
  if (!begins_straight(limits, interval_.at(in_, 1.0, 0.0, limits.axes), from.rate, law)) return false;
  take_along(limits.axes);
  const Box box = box_along(direction_, limits, share);
  const MotionState now{0.0, forwards_ * from.rate * law.v,
                        forwards_ * (law.a * from.rate * from.rate + law.v * from.slope)};
  const double natural = now.v + 0.5 * now.a * std::abs(now.a) / box.jerk;
  if (!(now.v >= 0.0 && natural >= 0.0)) return false;
  first_ = from.knot;
  first_in_ = in_;
  if (!aim(view, limits, now, std::max(0.0, forwards_ * target), box, places)) return false;
  const double jerk = profile_.jerk(0.0);
  turns_ = jerk * now.a < 0.0 ? -now.a / jerk : 0.0;
  fastest_ = std::max({now.v, natural, profile_.end().v});
  return rewind(view, limits) && profile_.duration() > 0.0;
}

bool StraightRamp::rewind(const CourseView& view, const RateLimits& limits) noexcept {
  if (!take(view, first_, limits)) return false;
  in_ = first_in_;
  t_ = 0.0;
  return true;
}

bool StraightRamp::go(const CourseView& view, const RateLimits& limits, double t) noexcept {
  if (!move_to(view, limits, motion(t).s, nullptr)) return false;
  t_ = t;
  return look(motion(t), forwards_ * profile_.jerk(t));
}

/// Goes on to a place, by both sides of the knots between.
bool StraightRamp::keeps_to(const CourseView& view, const RateLimits& limits, double t,
                            int& places) noexcept {
  const double s0 = motion(t_).s, s1 = motion(t).s;
  const bool forwards = s1 > s0;
  const double last = t_;
  const auto keeps_at = [&](double time) {
    --places;
    return look(motion(time), forwards_ * profile_.jerk(time)) && interval_.keeps(in_, state_, limits);
  };
  while (forwards ? s1 > along_.at(1.0) : s1 < along_.at(0.0)) {
    const double knot = along_.at(forwards ? 1.0 : 0.0);
    const double time = last + std::clamp((knot - s0) / (s1 - s0), 0.0, 1.0) * (t - last);
    in_ = forwards ? interval_.seconds() : 0.0;
    if (!keeps_at(time) || places <= 0 || !step_on(view, limits, forwards)) return false;
    in_ = forwards ? 0.0 : interval_.seconds();
    if (!keeps_at(time)) return false;
  }
  const Quintic& tau = interval_.tau();
  in_ = solve(along_, tau, s1, in_ / tau.seconds) * tau.seconds;
  places -= kSolve;
  t_ = t;
  return keeps_at(t);
}

/// Where it is looked at next, at the latest behind `step`: both sides of where the jerk changes, and where
/// the speed is at its greatest or least. While the law's speed is constant nothing else is needed: there the
/// acceleration goes straight from one to the next.
double StraightRamp::next_place(double t, double step) const noexcept {
  if (interval_.even() && fastest_ > 0.0) {
    const double s = motion(t).s;
    const double left = forwards_ > 0.0 ? along_.at(1.0) - s : s - along_.at(0.0);
    step = std::max(step, left / fastest_);
  }
  double to = std::min(t + step, profile_.duration());
  if (turns_ > t) to = std::min(to, turns_);
  for (int n = 1; n < profile_.size(); ++n)
    for (const double side : {-kBesideBreak, kBesideBreak})
      if (profile_.begins(n) + side > t) to = std::min(to, profile_.begins(n) + side);
  return to;
}

Fit StraightRamp::verify(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  const double whole = profile_.duration();
  const double step = (whole > 1.0 ? 3.0 : whole > 0.5 ? 2.0 : 1.0) * kPlace;
  double most = 1.0;
  for (double t = 0.0;; t = next_place(t, step)) {
    if (places <= 0) return Fit::open;
    if (!keeps_to(view, limits, t, places)) return Fit::breaks;
    const double rate = std::abs(state_.rate);
    // Out of speeding up above full rate it goes on up for a while.
    if (t == 0.0 && rate > 1.0) most = rate * fastest_ / profile_.at(0.0).v;
    if (!(rate <= most + kAbove)) return Fit::breaks;
    if (t >= whole) return Fit::fits;
  }
}

}  // namespace servogate::path
