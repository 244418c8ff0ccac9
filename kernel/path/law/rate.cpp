// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/rate.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr double kPlace = 0.001;   // s between places that are looked at
constexpr double kShare = 0.9997;  // of the limits: what may lie between two places
constexpr double kShortest = 0.04, kLongest = 6.0, kLonger = 1.18;

double power_of(double z, int n) noexcept {
  double out = 1.0;
  for (int i = 0; i < n; ++i) out *= z;
  return out;
}

/// The step that goes late, its derivatives and its integral, by the share of time.
struct Late {
  int p;
  double value(double z) const noexcept { return power_of(z, p + 1) * ((p + 2) - (p + 1) * z); }
  double d1(double z) const noexcept { return (p + 1) * (p + 2) * power_of(z, p) * (1.0 - z); }
  double d2(double z) const noexcept { return (p + 1) * (p + 2) * power_of(z, p - 1) * (p - (p + 1) * z); }
  double integral(double z) const noexcept { return power_of(z, p + 2) * (1.0 - (p + 1.0) / (p + 3.0) * z); }
};

}  // namespace

// Slowing down (in size) late; speeding up is its mirror. What is left of the slope goes with z (1 - z)^3.
double RateChange::rate(double t) const noexcept {
  const double z = std::clamp(t / seconds, 0.0, 1.0), y = 1.0 - z, h = r1 - r0;
  const bool up = std::abs(r1) > std::abs(r0);
  return r0 + h * (up ? 1.0 - Late{power}.value(y) : Late{power}.value(z)) + slope0 * seconds * z * y * y * y;
}

double RateChange::slope(double t) const noexcept {
  const double z = std::clamp(t / seconds, 0.0, 1.0), y = 1.0 - z, h = r1 - r0;
  const bool up = std::abs(r1) > std::abs(r0);
  return h * Late{power}.d1(up ? y : z) / seconds + slope0 * y * y * (1.0 - 4.0 * z);
}

double RateChange::bend(double t) const noexcept {
  const double z = std::clamp(t / seconds, 0.0, 1.0), y = 1.0 - z, h = r1 - r0;
  const bool up = std::abs(r1) > std::abs(r0);
  const double d2 = up ? -Late{power}.d2(y) : Late{power}.d2(z);
  return h * d2 / (seconds * seconds) - 6.0 * slope0 / seconds * y * (1.0 - 2.0 * z);
}

double RateChange::passed(double t) const noexcept {
  const double in = std::min(t, seconds), z = in / seconds, y = 1.0 - z, h = r1 - r0;
  const bool up = std::abs(r1) > std::abs(r0);
  const Late late{power};
  const double step = up ? z - (late.integral(1.0) - late.integral(y)) : late.integral(z);
  const double rest = z * z * (0.5 - z * (1.0 - z * (0.75 - 0.2 * z)));
  return r0 * in + h * seconds * step + slope0 * seconds * seconds * rest + r1 * (t - in);
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

CoursePoint CoursePlace::at(const LawTime& t, int axes) const noexcept {
  const Knot* four[4];
  if (!stretch(four)) return {};
  const double in = t.since(four[2]->t);
  CoursePoint out = Stretch(four).at(in, axes);
  // At rest before the start and behind the end.
  if (in < 0.0 || in > four[3]->t.since(four[2]->t)) out.d1 = out.d2 = out.d3 = {};
  return out;
}

Vector CoursePlace::position(const LawTime& t, int axes) const noexcept {
  const Knot* four[4];
  return stretch(four) ? Stretch(four).position(t.since(four[2]->t), axes) : Vector{};
}

namespace {

bool keeps(const CoursePoint& p, double r, double slope, double bend, const RateLimits& limits) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const AxisLimits& l = limits.limits[i];
    if (std::abs(p.d1[i] * r) > l.velocity) return false;
    if (std::abs(p.d2[i] * r * r + p.d1[i] * slope) > kShare * l.acceleration) return false;
    if (std::abs(p.d3[i] * r * r * r + 3.0 * p.d2[i] * r * slope + p.d1[i] * bend) > kShare * l.jerk)
      return false;
  }
  return true;
}

}  // namespace

/// Both sides of the knots between two places.
bool Verification::keeps_at_knots(const CourseView& view, std::int64_t to, const RateLimits& limits,
                                  int& places) const noexcept {
  const std::int64_t low = std::min(before_, to), high = std::max(before_, to);
  const double p0 = change_.passed(last_), p1 = change_.passed(t_);
  for (std::int64_t m = low; m < high; ++m) {
    const Knot* knot = view.knot(m);
    if (knot == nullptr) return false;
    const double there = knot->t.since(from_);
    const double share = p1 != p0 ? std::clamp((there - p0) / (p1 - p0), 0.0, 1.0) : 0.0;
    const double t = last_ + share * (t_ - last_);
    for (const std::int64_t side : {m, m + 1}) {
      if (side < 1) continue;
      CoursePlace place(view);
      place.set_knot(side);
      --places;
      if (!keeps(place.at(knot->t, limits.axes), change_.rate(t), change_.slope(t), change_.bend(t), limits))
        return false;
    }
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
  for (;; t_ = std::min(t_ + kPlace, change_.seconds)) {
    if (places <= 0) return Fit::open;
    const double r = change_.rate(t_);
    if (!(std::abs(r) <= 1.0 + 1e-12)) return Fit::breaks;
    // A change that does not go through rest does not turn round on the way.
    if (change_.r0 * change_.r1 >= 0.0 && r * (change_.r0 + change_.r1) < -1e-12) return Fit::breaks;
    const LawTime at = from_.plus(change_.passed(t_));
    if (!place.go(at)) return Fit::unpublished;
    --places;
    if (!keeps(place.at(at, limits.axes), r, change_.slope(t_), change_.bend(t_), limits)) return Fit::breaks;
    if (t_ > 0.0 && place.knot() != before_ && !keeps_at_knots(view, place.knot(), limits, places))
      return Fit::breaks;
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
  time_ = time_.plus(change_.passed(into_ + period) - change_.passed(into_));
  into_ += period;
  rate_ = change_.rate(into_);
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
  const double slope = active_ ? change_.slope(into_) : 0.0;
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
