// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>

#include "kernel/path/law/rate_motion.hpp"

namespace servogate::path {
namespace {

constexpr double kShortest = RateChange::kShortest;
constexpr double kSameTime = 2e-12;  // s

}  // namespace

void RateMotion::begin(double rate) noexcept {
  *this = RateMotion(limits_);
  rate_ = rate;
}

void RateMotion::advance(const CourseView& view, double period) noexcept {
  if (on_ramp_) return advance_on_ramp(view, period);
  if (!active_) {
    time_ = time_.plus(rate_ * period);
    return;
  }
  const double before = change_at(into_).passed;
  into_ += period;
  const RateState now = change_at(into_);
  time_ = time_.plus(now.passed - before);
  rate_ = now.rate;
  slope_ = now.slope;
  if (into_ < change_.seconds) return;
  active_ = false;
  rate_ = change_.r1;
  slope_ = 0.0;
}

void RateMotion::start(const RateChange& change) noexcept {
  change_ = change;
  into_ = 0.0;
  active_ = true;
  on_ramp_ = on_plan_ = false;
  prepared_ = {};
  sooner_.cycles = 0;
  sooner_.fits = false;
  stuck_ = creeping_ = levels_ = false;
  if (change.r1 != 0.0) starving_ = false;
}

/// Seconds until the knot of a stop; below 0: it lies behind, or is not known.
double RateMotion::until(const CourseView& view, const StopHint& hint) const noexcept {
  const Knot* knot = hint.knot >= 0 ? view.knot(hint.knot) : nullptr;
  if (knot == nullptr || active_ || !(rate_ > 0.0 && rate_ <= 1.0)) return -1.0;
  return knot->t.since(time_) / rate_;
}

/// A stop holds from its knot on, which may be reached in this cycle; at a lower rate it takes longer, by the
/// same way.
bool RateMotion::stop_at(const CourseView& view, const StopHint& hint, double period) noexcept {
  const double in = until(view, hint);
  if (in < 0.0 || in > period) return false;
  time_ = view.knot(hint.knot)->t;
  start({rate_, 0.0, 0.0, hint.seconds / rate_, hint.power});
  advance(view, period - in);
  return true;
}

bool RateMotion::stop_in_time(const CourseView& view, double target, double period) noexcept {
  settled_ = false;
  if (active_) return false;
  if (target >= 0.0 && target < rate_) {
    const StopHint hint = view.stop_near(knot_);
    if (stop_at(view, hint, period)) return true;
    settled_ = until(view, hint) > 0.0;
  }
  if (view.end() >= 0 || !stop_at(view, view.guard(), period)) return false;
  starving_ = target != 0.0;
  return true;
}

/// Up and back again at once; one try a cycle, shorter and longer ones in turn.
void RateMotion::surge(const CourseView& view, double target, double period) noexcept {
  constexpr double kShares[] = {1.0, 0.4};
  constexpr double kLengths[] = {0.1, 0.16, 0.25, 0.4, 0.6};
  constexpr int kTries = static_cast<int>(std::size(kShares) * std::size(kLengths));
  const int n = surges_tried_;
  surges_tried_ = (n + 1) % kTries;
  const double seconds = kLengths[static_cast<std::size_t>(n) % std::size(kLengths)];
  const double rate = rate_ + (target - rate_) * kShares[static_cast<std::size_t>(n) / std::size(kLengths)];
  const RateChange up{rate_, 0.0, rate, seconds, 3}, down{rate, 0.0, 1.0, seconds, 3};
  Verification way;
  way.begin(up, time_, knot_, period);
  if (way.go(view, limits_, left_) != Fit::fits) return;
  way.begin(down, time_.plus(up.at(seconds).passed), way.knot(), period);
  if (way.go(view, limits_, left_) != Fit::fits) return;
  start(up);
  back_ = down;
  back_in_ = 0.0;
  surges_tried_ = n;
}

/// So much longer at this rate, and back from there.
void RateMotion::put_off(const CourseView& view, double period) noexcept {
  constexpr double kMore = 0.016, kFar = 0.04;
  if (back_in_ > kFar) return;
  const RateChange on{rate_, 0.0, rate_, kMore, 3};
  Verification way;
  way.begin(on, time_.plus(rate_ * back_in_), knot_, period);
  if (way.go(view, limits_, left_) != Fit::fits) return;
  const LawTime there = time_.plus(rate_ * (back_in_ + kMore));
  const std::int64_t knot = way.knot();
  way.begin(back_, there, knot, period);
  if (way.go(view, limits_, left_) == Fit::fits) back_in_ += kMore;
}

/// The way back from above 1 begins in this cycle.
bool RateMotion::come_back(const CourseView& view, double period) noexcept {
  if (active_ || rate_ <= 1.0) return false;
  if (back_in_ >= period) {
    back_in_ -= period;
    return false;
  }
  const double until = back_in_;
  time_ = time_.plus(rate_ * until);
  start(back_);
  advance(view, period - until);
  return true;
}

/// Where speeding up would end in a long stop from a low rate.
bool RateMotion::near_last_stop(const CourseView& view) const noexcept {
  constexpr double kNear = 0.5;  // s
  const Knot* stop = view.knot(view.guard().knot);
  return stop != nullptr && stop->t.since(time_) < kNear;
}

/// What is left of the way to where a broken course rests; the next cycle goes on looking.
void RateMotion::creep(const CourseView& view, double target) noexcept {
  constexpr double kPeak = 1.875;  // of the rate, against the mean
  RateChange change{0.0, 0.0, 0.0};
  change.way = view.rests_at()->since(time_);
  if (!creeping_ || searched_for_ != target) {
    creeping_ = true;
    prepared_ = {};
    searched_for_ = target;
    next_ = std::max(kShortest, kPeak * std::abs(change.way) / std::min(1.0, target));
  }
  while (left_ > 0) {
    change.seconds = next_;
    left_ -= kTry;
    if (prepared_.cycles == 0) prepared_.verification.begin(change, time_, knot_);
    const Fit fit = prepared_.verification.go(view, limits_, left_);
    if (fit == Fit::fits) return start(change);
    prepared_.cycles = fit == Fit::open ? kAtRest : 0;
    if (fit != Fit::open) next_ *= RateChange::kLonger;
  }
}

/// A stop that leads there would have to come back to where a broken course rests.
bool RateMotion::beyond_rest(const CourseView& view, const LawTime& at) noexcept {
  const LawTime* rest = view.rests_at();
  return rest != nullptr && at.since(*rest) > kSameTime;
}

bool RateMotion::rests_there(const CourseView& view) noexcept {
  const LawTime* rest = view.rests_at();
  if (rest == nullptr || !at_rest() || std::abs(time_.since(*rest)) > kSameTime) return false;
  time_ = *rest;
  return true;
}

void RateMotion::seek(const CourseView& view, double target, double period) noexcept {
  if (target > 0.0 && at_rest() && (stuck_ || near_last_stop(view)) && view.rests_at() != nullptr)
    return creep(view, target);
  const bool above = !active_ && rate_ > 1.0;
  if (target <= 1.0) {
    if (target != wanted()) search(view, target, period);
  } else if (above && target >= rate_) {
    put_off(view, period);
    if (target > rate_) surge(view, target, period);
  } else if (wanted() < 1.0) {
    search(view, 1.0, period);
  } else if (!active_ && rate_ == 1.0) {
    surge(view, target, period);
  }
}

bool RateMotion::step(const CourseView& view, double target, double period) noexcept {
  left_ = kMostPlaces;
  if (target == wanted()) ramp_tried_ = false;
  begin_prepared(target);
  if (target != 0.0) sooner_ = {};
  begin_sooner_stop();
  if (sooner_.cycles == 0) seek(view, target, period);
  if (target == 0.0) seek_sooner_stop(view, period);
  if (!come_back(view, period) && !stop_in_time(view, target, period)) advance(view, period);
  const bool there = rests_there(view);
  CoursePlace place(view);
  place.set_knot(knot_);
  place.go(time_);
  knot_ = place.knot();
  const Knot* last = view.knot(knot_);
  const bool ended = view.end() == knot_ && last != nullptr && time_.since(last->t) >= 0.0 && rate_ > 0.0;
  const bool begun = time_.ns <= 0 && rate_ < 0.0;
  return !(ended || begun || there);
}

CoursePoint RateMotion::point(const CourseView& view) const noexcept {
  Interval interval;
  if (!interval.take(view, knot_, limits_)) return {};
  return interval.at(time_.since(interval.begin()), rate_, slope_, limits_.axes);
}

}  // namespace servogate::path
