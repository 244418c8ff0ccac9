// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/motion.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr int kBridgedSpans = 96;     // the longest way to rest across spans
constexpr int kSlowSpans = 12;        // among them, slower than the motion is now
constexpr double kSamePlace = 1e-10;  // mm

/// Speed that is reached when the acceleration is taken back at once.
double settled_speed(const MotionState& m, const Box& box) {
  return m.v + 0.5 * m.a * std::abs(m.a) / box.jerk;
}

/// What the rest of a span is asked for from this state.
Goal goal(const Span& span, const Span* behind, const MotionState& from, const Wish& wish,
          double largest_override) {
  const Terms& terms = span.terms;
  Goal g;
  g.length = span.length - from.s;
  g.exit_limit = terms.exit_limit;
  if (wish.rest) return g;
  const double ratio = terms.feed.rapid ? std::min(wish.override_ratio, 1.0) : wish.override_ratio;
  const auto asked = [&](const Feed& of) {
    return ratio * (of.per_turn > 0.0 && wish.spindle >= 0.0 ? of.per_turn * wish.spindle : of.speed);
  };
  g.velocity = std::min(terms.box.velocity, asked(terms.feed));
  g.exit = std::min(terms.exit_nominal, g.velocity);
  const double r = std::min(ratio * spindle_share(terms.feed, wish.spindle), largest_override);
  if (r > 1.0) {
    const double share = (r - 1.0) / std::max(largest_override - 1.0, 1e-9);
    g.exit = std::min(g.velocity, terms.exit_nominal + share * (terms.exit_limit - terms.exit_nominal));
  }
  if (behind != nullptr) g.exit = std::min(g.exit, asked(behind->terms.feed));
  return g;
}

/// Rounding at the border of what is feasible: the profile that leaves the span as slowly as possible.
bool plan_to_leave(Profile& profile, const MotionState& from, const Box& box, Goal wanted) {
  wanted.exit_limit = wanted.exit = wanted.velocity = box.velocity;
  return plan(profile, from, wanted, box);
}

}  // namespace

void Motion::begin(const Ahead& ahead, const Wish& wish) noexcept {
  state_.s = 0.0;
  length_ = ahead.span(0)->length;
  clock_ = 0.0;
  profile_.start(state_);
  resting_ = wish.rest;
  stale_ = false;
  if (replan(ahead, wish)) return;
  const Span& span = *ahead.span(0);
  plan_to_leave(profile_, state_, span.terms.box, goal(span, ahead.span(1), state_, wish, largest_override_));
}

void Motion::pass(double length, const Ahead& ahead, const Wish& wish) noexcept {
  if (!bridging_) return begin(ahead, wish);
  base_ += length;
  state_.s -= length;
  length_ = ahead.span(0)->length;
}

void Motion::rest() noexcept {
  state_ = {};
  bridging_ = false;
}

void Motion::obey(const Ahead& ahead, const Wish& wish) noexcept {
  if (wish.rest != resting_) stale_ = true;
  resting_ = wish.rest;
  if (stale_ && !(wish.rest && bridging_)) stale_ = !replan(ahead, wish);
  if (wish.rest && !bridging_ && profile_.end().v > 0.0) bridge(ahead);
}

bool Motion::replan(const Ahead& ahead, const Wish& wish) noexcept {
  const Span& span = *ahead.span(0);
  const Goal wanted = goal(span, ahead.span(1), state_, wish, largest_override_);
  if (!plan(profile_, state_, wanted, span.terms.box)) return false;
  const MotionState& end = profile_.end();
  if (std::abs(end.s - span.length) < kSamePlace) profile_.finish_at({span.length, end.v, end.a});
  clock_ = 0.0;
  bridging_ = false;
  base_ = 0.0;
  return true;
}

/// True when the way to rest enters each span behind the present one no faster than its box allows, and not
/// speeding up.
bool Motion::bridge_clears(const Ahead& ahead, const Profile& way, int spans,
                           const Box& least) const noexcept {
  const double fastest = std::max(state_.v, settled_speed(state_, least));
  double place = ahead.span(0)->length;
  int slow = 0;
  for (int n = 1; n <= spans; ++n) {
    const Span& span = *ahead.span(n);
    const double allowed = span.terms.box.velocity;
    if (state_.a > 0.0 || fastest > allowed) {
      if (++slow > kSlowSpans) return false;
      double early = 0.0, late = way.duration();
      for (int round = 0; round < 30; ++round) {
        const double middle = 0.5 * (early + late);
        (way.at(middle).s < place ? early : late) = middle;
      }
      const MotionState there = way.at(early);
      if (there.a > 0.0 || there.v > allowed) return false;
    }
    place += span.length;
  }
  return true;
}

/// The fastest way to rest that any of the spans it crosses allows, instead of one S-curve in each of them.
bool Motion::bridge(const Ahead& ahead) noexcept {
  const Span* last = ahead.span(0);
  Box least = last->terms.box;
  double known = last->length - state_.s;
  for (int n = 0; n <= kBridgedSpans; ++n) {
    // With the lower jerk of a span ahead the acceleration may take too long to be taken back: the motion
    // would become too fast, or turn back.
    const double settled = settled_speed(state_, least);
    if (std::abs(state_.a) > least.acceleration || settled < 0.0) return false;
    if (state_.a > 0.0 && settled > ahead.span(0)->terms.box.velocity) return false;
    const double way = ramp_distance(state_.v, state_.a, 0.0, least);
    if (way <= known) {
      Profile profile;
      profile.start(state_);
      add_ramp(profile, state_.v, state_.a, 0.0, least);
      profile.finish_at({state_.s + way, 0.0, 0.0});
      if (!bridge_clears(ahead, profile, n, least)) return false;
      profile_ = profile;
      clock_ = base_ = 0.0;
      bridging_ = true;
      return true;
    }
    const Span* next = ahead.span(n + 1);
    if (last->stop || next == nullptr) return false;
    known += next->length;
    least.acceleration = std::min(least.acceleration, next->terms.box.acceleration);
    least.jerk = std::min(least.jerk, next->terms.box.jerk);
    last = next;
  }
  return false;
}

bool Motion::advance(double& left, const Ahead& ahead) noexcept {
  if (bridging_) {
    if (left > 0.0) {
      clock_ = std::min(clock_ + left, profile_.duration());
      state_ = profile_.at(clock_);
      state_.s -= base_;
      left = 0.0;
    }
    return state_.s > length_ && ahead.span(1) != nullptr;
  }
  const double until_end = profile_.duration() - clock_;
  if (left < until_end) {
    clock_ += left;
    state_ = profile_.at(clock_);
    return false;
  }
  clock_ = profile_.duration();
  state_ = profile_.end();
  if (state_.s < length_) return false;  // at rest on the path, or a profile that must be planned anew
  left -= std::max(0.0, until_end);
  return true;
}

double Timing::through(const Span& span, const Span* behind) {
  const Goal wanted = goal(span, behind, at_, {}, 1.0);
  const Box& box = span.terms.box;
  profile_.start(at_);
  double seconds = span.length / std::max(box.velocity, 1e-9);
  if (plan(profile_, at_, wanted, box) || plan_to_leave(profile_, at_, box, wanted)) {
    seconds = profile_.duration();
    at_ = {0.0, profile_.end().v, profile_.end().a};
  }
  if (span.stop) at_ = {};
  return seconds;
}

}  // namespace servogate::path
