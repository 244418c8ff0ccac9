// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/motion.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr double kSamePlace = 1e-10;  // mm

/// What the rest of a span is asked for from the place `s`.
Goal goal(const Span& span, double s, const Wish& wish) {
  const Feed& feed = span.terms.feed;
  Goal g;
  g.length = span.length - s;
  if (wish.rest) return g;
  const double ratio = feed.rapid ? std::min(wish.override_ratio, 1.0) : wish.override_ratio;
  const bool turned = feed.per_turn > 0.0 && wish.spindle >= 0.0;
  g.velocity =
      std::min(span.terms.box.velocity, ratio * (turned ? feed.per_turn * wish.spindle : feed.speed));
  return g;
}

}  // namespace

void Motion::begin(const Span& span, const Wish& wish) noexcept {
  state_ = {};
  length_ = span.length;
  clock_ = 0.0;
  profile_.start(state_);
  resting_ = wish.rest;
  stale_ = !replan(span, wish);
}

void Motion::obey(const Span& span, const Wish& wish) noexcept {
  if (wish.rest != resting_) stale_ = true;
  resting_ = wish.rest;
  if (stale_) stale_ = !replan(span, wish);
}

bool Motion::replan(const Span& span, const Wish& wish) noexcept {
  if (!plan(profile_, state_, goal(span, state_.s, wish), span.terms.box)) return false;
  if (std::abs(profile_.end().s - length_) < kSamePlace) profile_.finish_at({length_, 0.0, 0.0});
  clock_ = 0.0;
  return true;
}

bool Motion::advance(double seconds) noexcept {
  clock_ = std::min(clock_ + seconds, profile_.duration());
  state_ = clock_ < profile_.duration() ? profile_.at(clock_) : profile_.end();
  return clock_ >= profile_.duration() && state_.s >= length_;
}

Profile as_planned(const Span& span) {
  Profile profile;
  profile.start({});
  plan(profile, {}, goal(span, 0.0, {}), span.terms.box);
  return profile;
}

}  // namespace servogate::path
