// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "kernel/path/law/rate_motion.hpp"

namespace servogate::path {
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
  // A ramp that is on its way goes on where the try is in vain.
  std::optional<PathRamp> now;
  if (on_ramp_) now = ramp_;
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
  if (!fits || !ramp_.rewind(view, limits_)) {
    if (now) ramp_ = *now;
    change_ = then;
    return false;
  }
  start(change_);
  on_ramp_ = true;
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

/// What slows down, or speeds up, at once as fast as the axes can. Where that was in vain, each other cycle
/// belongs to the search, which may need all of its places.
bool RateMotion::early(const CourseView& view, double target, double period) noexcept {
  if (on_ramp_ && ramp_.to_rest() && target * rate_ < 0.0) return true;  // rests first, to turn round
  ramp_tried_ = !ramp_tried_;
  return ramp_tried_ && ramp(view, target, period);
}

}  // namespace servogate::path
