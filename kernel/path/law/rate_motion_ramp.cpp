// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "kernel/path/law/rate_motion.hpp"
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {
namespace {

/// From here on, or from a little ahead, the path is a line for some knots; elsewhere the other ways to stop
/// are as good.
bool line_near(const CourseView& view, const RateLimits& limits, std::int64_t m) noexcept {
  constexpr int kApart = 12;
  constexpr double kAside = 2.5e-3;  // square of a direction
  Vector before{};
  for (int n = 0; n <= 4 * kApart; ++n, m = next_of(view, m)) {
    if (n % kApart != 0) continue;
    Interval interval;
    if (!interval.take(view, m, limits)) return false;
    const Vector v = interval.at(interval.seconds(), 1.0, 0.0, limits.axes).v;
    const double speed = norm(v, limits.axes);
    if (!(speed > 0.0)) return false;
    double aside = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double x = v[i] / speed, d = x - before[i];
      aside += d * d;
      before[i] = x;
    }
    if (n > 0 && aside < kAside) return true;
  }
  return false;
}

}  // namespace

void RateMotion::advance_on_ramp(const CourseView& view, double period) noexcept {
  into_ += period;
  const double beyond = into_ - ramp_.seconds();
  if (!ramp_.go(view, limits_, std::min(into_, ramp_.seconds()))) {
    // What was verified is published: a view that takes it back is left at the present rate, and the search
    // for what is wanted begins anew.
    on_ramp_ = active_ = false;
    rate_ = std::clamp(rate_, -1.0, 1.0);
    slope_ = 0.0;
    return advance(view, period);
  }
  time_ = ramp_.time();
  knot_ = ramp_.knot();
  rate_ = ramp_.state().rate;
  slope_ = ramp_.state().slope;
  if (beyond < 0.0) return;
  on_ramp_ = false;
  if (!ramp_.to_rest() && !ramp_.ends_even()) {
    into_ = 0.0;
    return advance(view, beyond);
  }
  active_ = false;
  rate_ = change_.r1;
  slope_ = 0.0;
  advance(view, beyond);
}

/// What brings the rate from the end of the ramp to the one that is wanted.
bool RateMotion::follow_ramp(const CourseView& view, double target, double period, int& places) noexcept {
  constexpr double kLengths[] = {RateChange::kShortest, 0.08};
  const RateState end = ramp_.state();
  for (const double seconds : kLengths) {
    change_ = {end.rate, end.slope, target, seconds, 3};
    Verification way;
    way.begin(change_, ramp_.time(), ramp_.knot(), period);
    if (way.go(view, limits_, places) == Fit::fits) return true;
  }
  return false;
}

/// The early way: as fast as the axes can, and where that is too fast, by less.
bool RateMotion::ramp(const CourseView& view, double target, double period) noexcept {
  constexpr double kLittle = 0.1;
  constexpr std::size_t kWhileSlowing = 3;  // plans: by less it would be slower than the law
  int places = std::exchange(left_, 0);
  // A ramp that is on its way, or about to begin, goes on where the try is in vain.
  std::optional<PathRamp> now;
  if (on_ramp_ || ramp_at_ >= 0) now = ramp_;
  const RateChange then = change_;
  bool fits = false;
  // A stop that is known and ends sooner is better.
  const StopHint hint = target == 0.0 && rate_ > 0.0 ? view.stop_near(knot_) : StopHint{};
  const double in = until(view, hint);
  const double known = in < 0.0 ? std::numeric_limits<double>::infinity() : in + hint.seconds / rate_;
  const bool begins = ramp_.begin(view, limits_, {time_, knot_, rate_, slope_}, target, places);
  const std::size_t plans = target == 0.0 && slows_down(view) ? kWhileSlowing : PathRamp::kPlans;
  for (std::size_t n = 0; begins && n < plans && !fits; ++n) {
    left_ -= kTry;
    if (places <= 0 || !ramp_.plan(view, limits_, n, places)) break;
    const bool rests = ramp_.to_rest(), even = ramp_.ends_even();
    if (!rests && !even && std::abs(target - rate_) < kLittle) break;
    if (rests && ramp_.seconds() > known) break;
    if (ramp_.verify(view, limits_, places) != Fit::fits) continue;
    if (rests && beyond_rest(view, ramp_.time())) continue;
    change_ = {rate_, slope_, rests ? 0.0 : target, ramp_.seconds(), 3};
    fits = rests || (even ? reaches_stop(view, ramp_.time(), target, period)
                          : follow_ramp(view, target, period, places));
  }
  left_ += places;
  const LawTime rests = ramp_.time();
  if (!fits || !ramp_.rewind(view, limits_)) {
    if (now) ramp_ = *now;
    change_ = then;
    return false;
  }
  start(change_);
  on_ramp_ = true;
  ramp_rests_ = rests;
  return true;
}

/// The law slows down here.
bool RateMotion::slows_down(const CourseView& view) const noexcept {
  constexpr double kSlowing = -0.5;  // 1/s
  Interval interval;
  if (!interval.take(view, knot_, limits_)) return false;
  const Interval::Pace law = interval.pace(time_.since(interval.begin()), limits_.axes);
  return law.a * rate_ < kSlowing * law.v;
}

/// The law slows down, before a corner, and leaves no room to slow down any sooner: the stop that begins in
/// a knot ahead, where there is room again. For a hold, in its first cycles.
bool RateMotion::ramp_ahead(const CourseView& view, const StopHint& hint) noexcept {
  constexpr double kSlower = 0.9;
  constexpr std::size_t kPlan = 2;
  constexpr int kMostKnots = 150, kNear = 3, kBehind = 24, kPlaces = 450, kCycles = 6;
  if (ramp_at_ >= 0) return true;
  ahead_.goes_on = false;
  if (active_ || !(rate_ > 0.0 && rate_ <= 1.0) || ahead_.cycles >= kCycles) return false;
  const double speed_now = std::abs(point(view).speed) / rate_;
  if (ahead_.cycles++ == 0) {
    left_ -= kTry;
    if (!line_near(view, limits_, knot_)) {
      ahead_.cycles = kCycles;
      return false;
    }
    ahead_ = {1, 0, 0, knot_, speed_now, slows_down(view)};
  }
  const double least = hint.knot < 0 ? std::numeric_limits<double>::infinity()
                                     : std::max(0.0, until(view, hint)) + hint.seconds / rate_;
  for (; ahead_.looked < kMostKnots; ++ahead_.looked, ahead_.knot = next_of(view, ahead_.knot)) {
    // The next cycle goes on before a corner; elsewhere there are other ways to stop.
    if (left_ < kPlaces) return ahead_.goes_on = ahead_.slowest < kSlower * speed_now || ahead_.slowing;
    Interval interval;
    --left_;
    if (!interval.take(view, ahead_.knot, limits_)) break;
    const double speed = interval.at(interval.seconds(), 1.0, 0.0, limits_.axes).speed;
    if (speed < ahead_.slowest) {
      ahead_.slowest = speed;
      if (ahead_.looked >= kNear) continue;
    } else if (++ahead_.behind > kBehind) {
      break;
    }
    const LawTime at = view.knot(ahead_.knot)->t;
    int places = kPlaces;
    left_ -= places;
    const bool fits =
        at.since(time_) >= 0.0 && ramp_.begin(view, limits_, {at, ahead_.knot, rate_, 0.0}, 0.0, places) &&
        ramp_.plan(view, limits_, kPlan, places) && at.since(time_) / rate_ + ramp_.seconds() < least &&
        ramp_.verify(view, limits_, places) == Fit::fits && !beyond_rest(view, ramp_.time());
    left_ += places;
    if (!fits) continue;
    ramp_rests_ = ramp_.time();
    if (!ramp_.rewind(view, limits_)) break;
    ramp_at_ = ahead_.knot;
    return true;
  }
  ahead_.cycles = kCycles;
  return false;
}

/// What is looked for ahead is of no use where nothing is to rest, or is about to; a wish that is new is
/// tried at once.
void RateMotion::forget_ramps(double target) noexcept {
  if (target == wanted()) ramp_tried_ = false;
  if (target == 0.0 && wanted() != 0.0) return;
  ahead_ = {};
  ramp_at_ = -1;
}

/// Its knot may be reached in this cycle.
bool RateMotion::start_ramp_ahead(const CourseView& view, double period) noexcept {
  if (ramp_at_ < 0) return false;
  const Knot* knot = view.knot(ramp_at_);
  if (knot == nullptr) {
    ramp_at_ = -1;
    return false;
  }
  const double in = std::max(0.0, knot->t.since(time_) / rate_);
  if (in > period) return false;
  time_ = knot->t;
  start({rate_, 0.0, 0.0, ramp_.seconds(), 3});
  on_ramp_ = true;
  advance(view, period - in);
  return true;
}

/// What slows down, or speeds up, at once as fast as the axes can. Where that was in vain, each other cycle
/// belongs to the search, which may need all of its places.
bool RateMotion::early(const CourseView& view, double target, const StopHint& hint, double period) noexcept {
  if (on_ramp_ && ramp_.to_rest() && target * rate_ < 0.0) return true;  // rests first, to turn round
  ramp_tried_ = !ramp_tried_;
  if (ramp_tried_ && ramp(view, target, period)) return true;
  return target == 0.0 && ramp_ahead(view, hint);
}

}  // namespace servogate::path
