// SPDX-License-Identifier: Apache-2.0
// How a change of the rate is found, cycle by cycle, that has been verified to its end.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/path/law/rate_motion.hpp"

namespace servogate::path {
namespace {

constexpr double kLeastShare = 0.03, kOfStop = 0.6;
constexpr double kShortest = RateChange::kShortest;
constexpr double kFarStop = 0.1;  // s; those between knots of a curve are nearer

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
bool RateMotion::foresee(const CourseView& view, double in, CourseState& at) const noexcept {
  if (!active_) {
    at = {time_.plus(rate_ * in), knot_, rate_, 0.0};
  } else if (on_ramp_) {
    PathRamp ramp = ramp_;
    if (into_ + in >= ramp.seconds() || !ramp.go(view, limits_, into_ + in)) return false;
    at = {ramp.time(), ramp.knot(), ramp.state().rate, ramp.state().slope};
  } else {
    const RateState now = change_at(into_);
    const RateState then = change_at(into_ + in);
    at = {time_.plus(then.passed - now.passed), knot_, then.rate, then.slope};
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
  CourseState at;
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

bool RateMotion::is_at(const LawTime& time, double rate, double slope) const noexcept {
  constexpr double kSame = 1e-9;
  return std::abs(rate_ - rate) < kSame && std::abs(slope_ - slope) < kSame &&
         std::abs(time_.since(time)) < kSame;
}

/// Where the motion has come to where it was foreseen.
void RateMotion::begin_prepared(double target) noexcept {
  if (target != searched_for_) prepared_ = {};
  if (prepared_.cycles == 0 || --prepared_.cycles > 0) return;
  const Verification& made = prepared_.verification;
  const RateChange change = made.change();
  if (std::exchange(prepared_.fits, false) && is_at(made.from(), change.r0, change.slope0)) start(change);
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

/// At once as fast as the axes can; else, cycle by cycle, all lengths from the shortest on.
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
    ramp_tried_ = false;
    share_ = 1.0;
    if (early(view, target, period)) return;
  } else if (preparing(view) || left_ <= 0 || early(view, target, period)) {
    return;
  } else if (active_ && !levels_ && target < rate_ && slope_ > 0.0 && level_off(view, period)) {
    return;
  }
  share_ = 1.0;
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

/// Until the motion rests by the stop that is on its way or settled.
double RateMotion::seconds_to_rest(const CourseView& view) const noexcept {
  constexpr double kNotKnown = 2.0;
  if (active_) return wanted() == 0.0 ? change_.seconds - into_ : kNotKnown;
  const StopHint hint = view.stop_near(knot_);
  const double in = until(view, hint);
  return in < 0.0 ? kNotKnown : in + hint.seconds / rate_;
}

/// Where the motion has come to where it was foreseen.
void RateMotion::begin_sooner_stop() noexcept {
  if (sooner_.cycles == 0 || --sooner_.cycles > 0) return;
  const StopPlan& plan = stop_search_.plan();
  if (!std::exchange(sooner_.fits, false) || !is_at(stop_search_.from().time, plan.r0, plan.slope0)) return;
  start({rate_, slope_, 0.0, plan.seconds, 3});
  plan_ = plan;
  on_plan_ = true;
}

/// What was known, or found first, need not be the soonest stop: others are looked for while it is on its
/// way.
void RateMotion::seek_sooner_stop(const CourseView& view, double period) noexcept {
  constexpr int kAhead = 6, kFirstPause = 16, kLongestPause = 128, kToVerify = 2, kLeast = 500;
  constexpr double kGain = 0.002;
  if (sooner_.pause > 0) {
    --sooner_.pause;
    return;
  }
  if (rate_ == 0.0 || std::abs(rate_) > 1.0 || sooner_.fits) return;
  if (sooner_.cycles == 0) {
    if (left_ < kLeast || prepared_.cycles > 0) return;
    const double in = kAhead * period, settled_in = until(view, view.stop_near(knot_));
    const double within = seconds_to_rest(view) - in - kGain;
    CourseState at;
    if (within < kShortest || (settled_in >= 0.0 && settled_in <= in) || !foresee(view, in, at)) return;
    stop_search_.begin(at, within);
    sooner_.cycles = kAhead;
  }
  left_ -= StopSearch::kPast;
  const Fit fit = stop_search_.go(view, limits_, sooner_.cycles < kToVerify, left_);
  left_ += StopSearch::kPast;
  sooner_.fits = fit == Fit::fits && !beyond_rest(view, stop_search_.rests_at());
  if (sooner_.fits || (fit == Fit::open && sooner_.cycles > 1)) return;
  sooner_.cycles = 0;
  sooner_.pause = std::min(kLongestPause, kFirstPause << std::min(sooner_.in_vain++, 4));
}

}  // namespace servogate::path
