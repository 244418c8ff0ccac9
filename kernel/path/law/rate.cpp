// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/rate.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr double kPlace = 0.001, kWidePlace = 0.002,
                 kGentle = 0.5;    // s between places; wide in changes longer than that
constexpr double kShare = 0.9997;  // of the limits: what may lie between two places
constexpr double kShortest = 0.04, kLongest = 6.0, kLonger = 1.18;

/// The step that goes late, its derivatives and its integral, by the share of time.
struct Late {
  double value, d1, d2, integral;

  Late(int p, double z) noexcept {
    double before = 1.0;  // z^(p - 1)
    for (int i = 1; i < p; ++i) before *= z;
    const double zp = before * z, next = p + 1.0, last = p + 2.0;
    value = zp * z * (last - next * z);
    d1 = next * last * zp * (1.0 - z);
    d2 = next * last * before * (p - next * z);
    integral = zp * z * z * (1.0 - next / (p + 3.0) * z);
  }
};

}  // namespace

// Slowing down (in size) late; speeding up is its mirror. What is left of the slope goes with z (1 - z)^3.
RateState RateChange::at(double t) const noexcept {
  const double in = std::min(t, seconds), z = in / seconds, y = 1.0 - z, h = r1 - r0;
  const bool up = std::abs(r1) > std::abs(r0);
  const Late late(power, up ? y : z);
  const double whole = 1.0 - (power + 1.0) / (power + 3.0);
  const double step = up ? 1.0 - late.value : late.value, bent = up ? -late.d2 : late.d2;
  const double passed = up ? z - (whole - late.integral) : late.integral;
  const double left = z * z * (0.5 - z * (1.0 - z * (0.75 - 0.2 * z)));
  return {r0 + h * step + slope0 * seconds * z * y * y * y,
          h * late.d1 / seconds + slope0 * y * y * (1.0 - 4.0 * z),
          h * bent / (seconds * seconds) - 6.0 * slope0 / seconds * y * (1.0 - 2.0 * z),
          r0 * in + h * seconds * passed + slope0 * seconds * seconds * left + r1 * (t - in)};
}

bool CoursePlace::go(const LawTime& t) noexcept {
  for (;;) {
    const Knot* to = view_->knot(m_);
    if (to == nullptr) return false;
    if (t.since(to->t) > 0.0) {
      if (m_ == view_->end()) return true;
      ++m_;
      continue;
    }
    const Knot* from = view_->knot(m_ - 1);
    if (from == nullptr) return false;
    if (t.since(from->t) >= 0.0 || m_ == 1) return true;
    --m_;
  }
}

bool CoursePlace::stretch(const Knot* (&four)[4]) const noexcept {
  for (std::int64_t q = 0; q < 4; ++q) {
    four[q] = view_->knot(m_ - 3 + q);
    if (four[q] == nullptr) return false;
  }
  return true;
}

Vector CoursePlace::position(const LawTime& t, int axes) const noexcept {
  const Knot* four[4];
  return stretch(four) ? Stretch(four).position(t.since(four[2]->t), axes) : Vector{};
}

bool Interval::take(const CourseView& view, std::int64_t m, int axes) noexcept {
  const Knot *k0 = view.knot(m - 3), *k1 = view.knot(m - 2), *k2 = view.knot(m - 1), *k3 = view.knot(m);
  if (k0 == nullptr || k1 == nullptr || k2 == nullptr || k3 == nullptr) return false;
  m_ = m;
  begin_ = k2->t;
  tau_ = Quintic::between(k3->t.since(k2->t), k2->w, k2->a, k3->w, k3->a);
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    const double p0 = k0->control[i], p1 = k1->control[i], p2 = k2->control[i], p3 = k3->control[i];
    slope_[i] = 0.5 * (p2 - p0);
    bend_[i] = p0 - 2.0 * p1 + p2;
    third_[i] = p3 - 3.0 * p2 + 3.0 * p1 - p0;
  }
  return true;
}

bool Interval::keeps(double in, const RateState& rate, const RateLimits& limits) const noexcept {
  if (in < 0.0 || in > tau_.seconds) return true;
  const double s = in / tau_.seconds, f = tau_.at(s), w = tau_.d1(s), w2 = tau_.d2(s), w3 = tau_.d3(s);
  // The curve's parameter by time, with the rate.
  const double r = rate.rate, v = w * r, a = w2 * r * r + w * rate.slope;
  const double j = w3 * r * r * r + 3.0 * w2 * r * rate.slope + w * rate.bend;
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const AxisLimits& l = limits.limits[i];
    const double y2 = bend_[i] + f * third_[i], y1 = slope_[i] + f * (bend_[i] + 0.5 * f * third_[i]);
    if (std::abs(y1 * v) > l.velocity) return false;
    if (std::abs(y2 * v * v + y1 * a) > kShare * l.acceleration) return false;
    if (std::abs(third_[i] * v * v * v + 3.0 * y2 * v * a + y1 * j) > kShare * l.jerk) return false;
  }
  return true;
}

/// Goes on to another interval; both sides of the knots between.
bool Verification::keeps_at_knots(const CourseView& view, std::int64_t to, const RateLimits& limits,
                                  int& places) noexcept {
  const double p0 = change_.at(last_).passed, p1 = change_.at(t_).passed;
  while (interval_.knot() != to) {
    const bool on = to > interval_.knot();
    const Knot* knot = view.knot(on ? interval_.knot() : interval_.knot() - 1);
    if (knot == nullptr) return false;
    const double there = knot->t.since(from_);
    const double share = p1 != p0 ? std::clamp((there - p0) / (p1 - p0), 0.0, 1.0) : 0.0;
    const RateState rate = change_.at(last_ + share * (t_ - last_));
    places -= 2;
    if (!interval_.keeps(on ? interval_.seconds() : 0.0, rate, limits)) return false;
    if (!interval_.take(view, interval_.knot() + (on ? 1 : -1), limits.axes)) return false;
    if (!interval_.keeps(on ? 0.0 : interval_.seconds(), rate, limits)) return false;
  }
  return true;
}

void Verification::begin(const RateChange& change, const LawTime& from, std::int64_t near_knot) noexcept {
  change_ = change;
  from_ = from;
  before_ = near_knot;
  t_ = last_ = 0.0;
}

Fit Verification::go(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  CoursePlace place(view);
  place.set_knot(before_);
  if (!interval_.take(view, before_, limits.axes)) return Fit::unpublished;
  const double next = change_.seconds > kGentle ? kWidePlace : kPlace;
  for (;; t_ = std::min(t_ + next, change_.seconds)) {
    if (places <= 0) return Fit::open;
    const RateState s = change_.at(t_);
    if (!(std::abs(s.rate) <= 1.0 + 1e-12)) return Fit::breaks;
    // A change that does not go through rest does not turn round on the way.
    if (change_.r0 * change_.r1 >= 0.0 && s.rate * (change_.r0 + change_.r1) < -1e-12) return Fit::breaks;
    const LawTime at = from_.plus(s.passed);
    if (!place.go(at)) return Fit::unpublished;
    --places;
    // Both sides of the knots on the way; a place at the very start may lie in the next interval.
    if (place.knot() != interval_.knot() && !keeps_at_knots(view, place.knot(), limits, places))
      return Fit::breaks;
    if (!interval_.keeps(at.since(interval_.begin()), s, limits)) return Fit::breaks;
    before_ = place.knot();
    last_ = t_;
    if (t_ >= change_.seconds) return Fit::fits;
  }
}

StopHint find_stop(const CourseView& view, std::int64_t knot, const StopHint& before,
                   const RateLimits& limits) {
  constexpr int kShorter = 4, kTries = 24, kPlaces = 1 << 20;
  constexpr double kStep = 0.85;
  const Knot* at = view.knot(knot);
  if (at == nullptr) return {};
  const auto fits = [&](double seconds, int power) {
    int places = kPlaces;
    Verification v;
    v.begin({1.0, 0.0, 0.0, seconds, power}, at->t, std::max<std::int64_t>(1, knot));
    return v.go(view, limits, places) == Fit::fits;
  };
  double seconds = before.seconds;
  int power = before.power;
  if (fits(seconds, power)) {
    for (int n = 0; n < kShorter && seconds * kStep > kShortest; ++n) {
      if (!fits(seconds * kStep, power)) {
        if (!fits(seconds * kStep, 5 - power)) break;
        power = 5 - power;
      }
      seconds *= kStep;
    }
    return {seconds, power, knot};
  }
  for (int n = 0; n < kTries && seconds < kLongest; ++n, seconds *= kLonger)
    for (const int p : {power, 5 - power})
      if (fits(seconds, p)) return {seconds, p, knot};
  return {before.seconds, before.power, -1};
}

void RateMotion::advance(double period) noexcept {
  if (!active_) {
    time_ = time_.plus(rate_ * period);
    return;
  }
  const double before = change_.at(into_).passed;
  into_ += period;
  const RateState now = change_.at(into_);
  time_ = time_.plus(now.passed - before);
  rate_ = now.rate;
  if (into_ < change_.seconds) return;
  active_ = false;
  rate_ = change_.r1;
}

void RateMotion::start(const RateChange& change) noexcept {
  change_ = change;
  into_ = 0.0;
  active_ = true;
  open_ = false;
}

Fit RateMotion::enter(const CourseView& view, double target, double seconds, int power) noexcept {
  const double slope = active_ ? change_.at(into_).slope : 0.0;
  verification_.begin({rate_, slope, target, seconds, power}, time_, knot_);
  const Fit fit = verification_.go(view, limits_, left_);
  if (fit == Fit::fits) start(verification_.change());
  return fit;
}

/// The hint holds from its knot on, which may be reached in this cycle.
bool RateMotion::stop_at(const CourseView& view, const StopHint& hint, double period) noexcept {
  const Knot* knot = hint.knot >= 0 ? view.knot(hint.knot) : nullptr;
  if (knot == nullptr) return false;
  const double until = knot->t.since(time_);
  if (until < 0.0 || until > period) return false;
  time_ = knot->t;
  start({1.0, 0.0, 0.0, hint.seconds, hint.power});
  advance(period - until);
  return true;
}

/// First the hint and longer ones; then, cycle by cycle, all lengths from the shortest on.
void RateMotion::search(const CourseView& view, double target, const StopHint& hint) noexcept {
  if (searched_for_ != target) {
    searched_for_ = target;
    next_ = kShortest;
    power_ = 3;
    open_ = false;
  }
  if (target == 0.0 && !active_ && rate_ == 1.0 && hint.seconds * 1000.0 < left_) {
    for (const double longer : {1.0, 1.18, 1.4})
      if (enter(view, target, hint.seconds * longer, longer == 1.4 ? 5 - hint.power : hint.power) ==
          Fit::fits)
        return;
  }
  if (open_) {
    const Fit fit = verification_.go(view, limits_, left_);
    if (fit == Fit::fits) return start(verification_.change());
    if (fit == Fit::open) return;
    open_ = false;
  }
  while (left_ > 0) {
    const Fit fit = enter(view, target, next_, power_);
    if (fit == Fit::fits) return;
    // At rest the place does not move, and the next cycle goes on; else it begins again with the shortest.
    open_ = fit == Fit::open && rate_ == 0.0 && !active_;
    power_ = 5 - power_;
    if (power_ == 3) next_ *= kLonger;
    if (next_ > kLongest || (fit == Fit::open && !open_)) next_ = kShortest;
  }
}

bool RateMotion::step(const CourseView& view, double target, const StopHint& hint, double period) noexcept {
  left_ = kMostPlaces;
  if (target != wanted()) search(view, target, hint);
  const bool stopping = target == 0.0 && !active_ && rate_ == 1.0;
  if (!stopping || !stop_at(view, hint, period)) advance(period);
  CoursePlace place(view);
  place.set_knot(knot_);
  place.go(time_);
  knot_ = place.knot();
  const Knot* last = view.knot(knot_);
  const bool ended = view.end() == knot_ && last != nullptr && time_.since(last->t) >= 0.0 && rate_ > 0.0;
  const bool begun = time_.ns <= 0 && rate_ < 0.0;
  return !(ended || begun);
}

Vector RateMotion::position(const CourseView& view) const noexcept {
  CoursePlace place(view);
  place.set_knot(knot_);
  place.go(time_);
  return place.position(time_, limits_.axes);
}

}  // namespace servogate::path
