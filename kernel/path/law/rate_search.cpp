// SPDX-License-Identifier: Apache-2.0
// How a change of the rate is found, cycle by cycle, that has been verified to its end.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "kernel/path/law/rate_motion.hpp"

namespace servogate::path {
namespace {

constexpr double kLeastShare = 0.03, kOfStop = 0.6;
constexpr double kShortest = RateChange::kShortest;
constexpr double kFarStop = 0.1;  // s; those between knots of a curve are nearer

/// Law time that passes in a stop from a constant rate of 1, as a share of its seconds.
double share_passed(int power) noexcept { return RateChange{1.0, 0.0, 0.0, 1.0, power}.at(1.0).passed; }

}  // namespace

Fit RateMotion::enter(const CourseView& view, double target, double seconds, int power,
                      double period) noexcept {
  left_ -= kTry;
  const RateChange change{rate_, slope_, target, seconds, power};
  if (target == 0.0 && beyond_rest(view, time_.plus(change.at(seconds).passed))) return Fit::breaks;
  if (!may_keep(view, change, time_, knot_, limits_, left_)) return Fit::breaks;
  needed_ = kMostPlaces;
  if (left_ <= 0) return Fit::open;
  const int before = left_;
  Verification verification;
  verification.begin(change, time_, knot_, period);
  const Fit fit = verification.go(view, limits_, left_);
  if (fit == Fit::fits) start(change);
  if (fit == Fit::open) {
    const double share = std::max(verification.reached(), 1e-3);
    needed_ = static_cast<int>(std::min(1e6, before / share));
  }
  return fit;
}

/// Where the motion will be in so many seconds, if nothing else is entered.
bool RateMotion::foresee(const CourseView& view, double in, PathRamp::From& at) const noexcept {
  if (!active_) {
    at = {time_.plus(rate_ * in), knot_, rate_, 0.0};
  } else if (on_ramp_) {
    PathRamp ramp = ramp_;
    if (into_ + in >= ramp.seconds() || !ramp.go(view, limits_, into_ + in)) return false;
    at = {ramp.time(), ramp.knot(), ramp.state().rate, ramp.state().slope};
  } else {
    const RateState then = change_.at(into_ + in);
    at = {time_.plus(then.passed - change_.at(into_).passed), knot_, then.rate, then.slope};
  }
  CoursePlace place(view);
  place.set_knot(at.knot);
  if (!place.go(at.time)) return false;
  at.knot = place.knot();
  return true;
}

/// A change for which the places of one cycle are not enough is verified over as many as it takes, from
/// where the motion will be by then.
void RateMotion::prepare(const CourseView& view, double target, double seconds, int power,
                         double period) noexcept {
  constexpr int kMostCycles = 16;
  prepared_ = {};
  if (at_rest()) {
    prepared_.cycles = kAtRest;
    prepared_.verification.begin({0.0, 0.0, target, seconds, power}, time_, knot_, period);
    return;
  }
  const int cycles = needed_ / kMostPlaces + 2;
  PathRamp::From at;
  if (cycles > kMostCycles || !foresee(view, cycles * period, at)) return;
  prepared_.cycles = cycles;
  prepared_.verification.begin({at.rate, at.slope, target, seconds, power}, at.time, at.knot, period);
}

/// One is being verified, or waits until it begins.
bool RateMotion::preparing(const CourseView& view) noexcept {
  if (prepared_.cycles == 0) return false;
  if (prepared_.fits) return true;
  const Fit fit = prepared_.verification.go(view, limits_, left_);
  if (fit == Fit::open) return true;
  prepared_.fits = fit == Fit::fits;
  if (prepared_.fits && at_rest()) start(prepared_.verification.change());
  if (!prepared_.fits) prepared_ = {};
  return fit == Fit::fits;
}

/// Where the motion has come to where it was foreseen.
void RateMotion::begin_prepared(double target) noexcept {
  constexpr double kSame = 1e-9;
  if (target != searched_for_) prepared_ = {};
  if (prepared_.cycles == 0 || --prepared_.cycles > 0) return;
  const Verification& made = prepared_.verification;
  const RateChange change = made.change();
  const bool there = std::abs(rate_ - change.r0) < kSame && std::abs(slope_ - change.slope0) < kSame &&
                     std::abs(time_.since(made.from())) < kSame;
  if (std::exchange(prepared_.fits, false) && there) start(change);
}

/// A stop like the known one, which begins a little before it, and longer ones; from a lower rate shorter
/// ones in each other cycle, as there is more room.
bool RateMotion::try_known(const CourseView& view, const StopHint& hint, double period) noexcept {
  constexpr double kLongerBy[] = {1.0, 1.18, 1.4}, kLower = 0.9;
  shorter_ = !shorter_ && rate_ < kLower;
  const double seconds = shorter_ ? std::max(kShortest, hint.seconds * std::sqrt(rate_))
                                  : hint.seconds / rate_ + std::max(0.0, until(view, hint));
  for (const double longer : kLongerBy) {
    if (left_ <= 0) return false;
    if (enter(view, 0.0, seconds * longer, longer == 1.4 ? 5 - hint.power : hint.power, period) == Fit::fits)
      return true;
  }
  return false;
}

/// Instead of speeding up any further, a constant rate soon: from there what is wanted is found.
bool RateMotion::level_off(const CourseView& view, double period) noexcept {
  constexpr double kLengths[] = {0.04, 0.06, 0.1}, kMore = 0.3;
  if (!(rate_ > 0.0)) return false;  // it would turn round
  for (const double seconds : kLengths) {
    if (left_ <= 0) return false;
    levels_ = enter(view, std::min(1.0, rate_ + kMore * slope_ * seconds), seconds, 3, period) == Fit::fits;
    if (levels_) return true;
  }
  return false;
}

/// First the known stop and longer ones; then, cycle by cycle, all lengths from the shortest on.
void RateMotion::search(const CourseView& view, double target, double period) noexcept {
  StopHint hint = view.stop_near(knot_);
  // Far away, at the end of a straight, it says nothing of here.
  if (until(view, hint) > kFarStop) hint = {};
  // A change by less takes less; where no stop is known, all lengths are tried.
  const double least =
      hint.knot < 0 ? kShortest : std::max(kShortest, kOfStop * hint.seconds * std::abs(target - rate_));
  const auto anew = [&] {
    next_ = least;
    power_ = 3;
  };
  if (searched_for_ != target) {
    searched_for_ = target;
    anew();
    shorter_ = ramp_tried_ = false;
    shorter_next_ = shorter_pause_ = shorter_rounds_ = 0;
    share_ = 1.0;
    if (early(view, target, hint, period)) return;
  } else if (preparing(view) || left_ <= 0 || early(view, target, hint, period)) {
    return;
  } else if (active_ && !levels_ && target < rate_ && slope_ > 0.0 && level_off(view, period)) {
    return;
  }
  share_ = 1.0;
  if (target == 0.0 && !active_ && hint.knot >= 0 && rate_ > 0.0 && try_known(view, hint, period)) return;
  while (left_ > 0) {
    const Fit fit = enter(view, share_ * target, next_, power_, period);
    if (fit == Fit::fits) return;
    // Longer changes would end behind all that is known, too.
    if (fit == Fit::unpublished && power_ == 2) {
      anew();
      share_ *= 0.5;
      stuck_ = share_ < kLeastShare && rate_ == 0.0;
      if (share_ < kLeastShare || share_ * target <= rate_) return;
      continue;
    }
    if (fit == Fit::open) prepare(view, share_ * target, next_, power_, period);
    power_ = 5 - power_;
    if (power_ == 3) next_ *= RateChange::kLonger;
    if (next_ > RateChange::kLongest) anew();
  }
}

/// Law time until the motion rests by the stop that is on its way or settled; 0: there is none.
double RateMotion::way_to_rest(const CourseView& view) const noexcept {
  if (active_ && wanted() != 0.0) return 0.0;
  if (active_ && !on_ramp_) return std::abs(change_.at(change_.seconds).passed - change_.at(into_).passed);
  if (active_ || ramp_at_ >= 0) return std::abs(ramp_rests_.since(time_));
  if (!settled_) return 0.0;
  const StopHint hint = view.stop_near(knot_);
  const double in = until(view, hint);
  return in > 0.0 ? in * rate_ + share_passed(hint.power) * hint.seconds : 0.0;
}

/// What was known, or found first, need not be the shortest stop: others are tried while it is on its way.
void RateMotion::shorten_stop(const CourseView& view, double period) noexcept {
  constexpr double kShares[] = {0.2, 0.25, 0.3, 0.36, 0.42, 0.5, 0.58, 0.66, 0.74, 0.82, 0.9, 0.96};
  constexpr int kTries = 2 * static_cast<int>(std::size(kShares)), kLongestPause = 16;
  if (shorter_pause_ > 0) {
    --shorter_pause_;
    return;
  }
  if (left_ <= 0 || rate_ == 0.0 || std::abs(rate_) > 1.0 || preparing(view)) return;
  const double way = way_to_rest(view);
  if (way == 0.0) return;
  for (; shorter_next_ < kTries; ++shorter_next_) {
    const int power = shorter_next_ % 2 == 0 ? 3 : 2;
    const double share = kShares[shorter_next_ / 2];
    const double seconds = share * way / (share_passed(power) * std::abs(rate_));
    if (seconds < kShortest) continue;
    const Fit fit = enter(view, 0.0, seconds, power, period);
    if (fit == Fit::fits) {
      shorter_rounds_ = 0;
      return;
    }
    if (fit != Fit::open) continue;
    prepare(view, 0.0, seconds, power, period);
    ++shorter_next_;
    return;
  }
  shorter_next_ = 0;
  shorter_pause_ = std::min(kLongestPause, 1 << std::min(++shorter_rounds_, 8));
}

}  // namespace servogate::path
