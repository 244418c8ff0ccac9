// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/rate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/axes/transformation.hpp"
#include "kernel/path/law/stop_plan.hpp"

namespace servogate::path {
namespace {

constexpr double kPlace = 0.001;  // s between places; in changes of half a second twice as far, of one thrice
constexpr double kShare = 0.9997;       // of the limits: what may lie between two places
constexpr double kInside = 1.0 - 1e-9;  // of an interval: the place is surely in it
constexpr double kAbove = 0.996;        // the same above full rate

/// s between the places that are looked at.
template <class Change>
double spacing(const Change& change) noexcept {
  if (std::max(change.r0, change.r1) > 1.0) return kPlace;
  return (change.seconds > 1.0 ? 3.0 : change.seconds > 0.5 ? 2.0 : 1.0) * kPlace;
}

/// Nearer than `apart` to this place the rate is at its least, which is on the other side of 0.
bool dips(const RateState& s, double sense, double apart) noexcept {
  constexpr double kLow = 0.05;
  if (std::abs(s.rate) > kLow) return false;
  const double sign = sense > 0.0 ? 1.0 : -1.0, slope = sign * s.slope, bend = sign * s.bend;
  return bend > 0.0 && std::abs(slope) <= bend * apart && sign * s.rate < slope * slope / (2.0 * bend);
}

/// The step that goes late, its derivatives and its integral, by the share of time.
struct Late {
  double value, d1, d2, integral;

  Late(int p, double z) noexcept {
    const double before = p == 3 ? z * z : z;  // z^(p - 1)
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
  const double per_second = 1.0 / seconds;
  const double in = std::min(t, seconds), z = in / seconds, y = 1.0 - z, h = r1 - r0;
  if (way != 0.0) {
    const double v = way / seconds, a = v / seconds, j = a / seconds;
    return {30.0 * v * z * z * y * y, 60.0 * a * z * y * (1.0 - 2.0 * z), 60.0 * j * (1.0 - 6.0 * z * y),
            way * z * z * z * (10.0 - z * (15.0 - 6.0 * z))};
  }
  const bool up = std::abs(r1) > std::abs(r0);
  const Late late(power, up ? y : z);
  const double whole = 1.0 - (power + 1.0) / (power + 3.0);
  const double step = up ? 1.0 - late.value : late.value, bent = up ? -late.d2 : late.d2;
  const double passed = up ? z - (whole - late.integral) : late.integral;
  if (slope0 == 0.0)
    return {r0 + h * step, h * late.d1 * per_second, h * bent * per_second * per_second,
            r0 * in + h * seconds * passed + r1 * (t - in)};
  const double left = z * z * (0.5 - z * (1.0 - z * (0.75 - 0.2 * z)));
  return {r0 + h * step + slope0 * seconds * z * y * y * y,
          h * late.d1 / seconds + slope0 * y * y * (1.0 - 4.0 * z),
          h * bent / (seconds * seconds) - 6.0 * slope0 / seconds * y * (1.0 - 2.0 * z),
          r0 * in + h * seconds * passed + slope0 * seconds * seconds * left + r1 * (t - in)};
}

std::int64_t begin_of(const CourseView& view, std::int64_t m) noexcept {
  const Knot* before = view.knot(m - 1);
  return before != nullptr && before->kind == Knot::Kind::join ? m - 4 : m - 1;
}

std::int64_t next_of(const CourseView& view, std::int64_t m) noexcept {
  const Knot* next = view.knot(m + 1);
  return next != nullptr && next->kind == Knot::Kind::guide ? m + 4 : m + 1;
}

bool CoursePlace::go(const LawTime& t) noexcept {
  for (;;) {
    const Knot* to = view_->knot(m_);
    if (to == nullptr) return false;
    if (t.since(to->t) > 0.0) {
      if (m_ == view_->end()) return true;
      const std::int64_t next = next_of(*view_, m_);
      if (view_->knot(next) == nullptr) return false;
      m_ = next;
      continue;
    }
    const std::int64_t begin = begin_of(*view_, m_);
    const Knot* from = view_->knot(begin);
    if (from == nullptr) return false;
    if (t.since(from->t) >= 0.0 || begin == 0) return true;
    m_ = begin;
  }
}

/// An affine map takes the spline to the axes by its derivatives.
void Interval::turn(const RateLimits& limits) noexcept {
  if (limits.transformation == &identity()) return;
  PathPoint begin{start_, slope_, bend_, third_};
  limits.transformation->to_axes(begin, limits.axes);
  start_ = begin.x;
  slope_ = begin.d1;
  bend_ = begin.d2;
  third_ = begin.d3;
}

bool Interval::take(const CourseView& view, std::int64_t m, const RateLimits& limits) noexcept {
  const int axes = limits.axes;
  const Knot *k0 = view.knot(m - 3), *k1 = view.knot(m - 2), *k2 = view.knot(m - 1), *k3 = view.knot(m);
  if (k0 == nullptr || k1 == nullptr || k2 == nullptr || k3 == nullptr) return false;
  m_ = m;
  begin_ = k2->t;
  place_ = k2->place;
  way_ = k3->place - k2->place;
  const double seconds = k3->t.since(k2->t);
  if (k3->kind == Knot::Kind::straight) {
    tau_ = {seconds, 1.0, 0.0, 0.0, 0.0, 0.0};
    even_ = true;
    bend_ = third_ = {};
    for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
      start_[i] = (k0->control[i] + 4.0 * k1->control[i] + k2->control[i]) / 6.0;
      slope_[i] = k3->control[i] - start_[i];
    }
    turn(limits);
    return true;
  }
  tau_ = Quintic::between(seconds, k2->w, k2->a, k3->w, k3->a);
  even_ = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    const double p0 = k0->control[i], p1 = k1->control[i], p2 = k2->control[i], p3 = k3->control[i];
    start_[i] = (p0 + 4.0 * p1 + p2) / 6.0;
    slope_[i] = 0.5 * (p2 - p0);
    bend_[i] = p0 - 2.0 * p1 + p2;
    third_[i] = p3 - 3.0 * p2 + 3.0 * p1 - p0;
  }
  turn(limits);
  return true;
}

double Interval::speed(double in, int axes) const noexcept {
  const double s = in / tau_.seconds, f = tau_.at(s);
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    const double y1 = slope_[i] + f * (bend_[i] + 0.5 * f * third_[i]);
    sum += y1 * y1;
  }
  return std::sqrt(sum) * tau_.d1(s);
}

Interval::Pace Interval::pace(double in, int axes) const noexcept {
  const double s = in / tau_.seconds, f = tau_.at(s), w = tau_.d1(s), w2 = tau_.d2(s), w3 = tau_.d3(s);
  double vv = 0.0, va = 0.0, aa = 0.0, vj = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    const double y2 = bend_[i] + f * third_[i], y1 = slope_[i] + f * (bend_[i] + 0.5 * f * third_[i]);
    const double v = y1 * w, a = y2 * w * w + y1 * w2;
    const double j = third_[i] * w * w * w + 3.0 * y2 * w * w2 + y1 * w3;
    vv += v * v;
    va += v * a;
    aa += a * a;
    vj += v * j;
  }
  const double v = std::sqrt(vv);
  if (!(v > 0.0)) return {0.0, 0.0, 0.0};
  const double a = va / v;
  return {v, a, (aa + vj - a * a) / v};
}

Vector Interval::jerk(double in, const RateState& rate, int axes) const noexcept {
  const double s = in / tau_.seconds, f = tau_.at(s), w = tau_.d1(s), w2 = tau_.d2(s), w3 = tau_.d3(s);
  const double r = rate.rate, v = w * r, a = w2 * r * r + w * rate.slope;
  const double j = w3 * r * r * r + 3.0 * w2 * r * rate.slope + w * rate.bend;
  Vector out{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    const double y2 = bend_[i] + f * third_[i], y1 = slope_[i] + f * (bend_[i] + 0.5 * f * third_[i]);
    out[i] = third_[i] * v * v * v + 3.0 * y2 * v * a + y1 * j;
  }
  return out;
}

double Interval::length(double from, double to, int axes) const noexcept {
  constexpr double kAside = 0.7745966692414834, kOuterPart = 5.0 / 18.0, kInnerPart = 8.0 / 18.0;
  const double mid = 0.5 * (from + to), half = 0.5 * (to - from);
  if (even_) return (to - from) * speed(mid, axes);
  return (to - from) * (kOuterPart * (speed(mid - kAside * half, axes) + speed(mid + kAside * half, axes)) +
                        kInnerPart * speed(mid, axes));
}

CoursePoint Interval::at(double in, double rate, double slope, int axes) const noexcept {
  CoursePoint out;
  const double s = std::clamp(in / tau_.seconds, 0.0, 1.0), f = std::clamp(tau_.at(s), 0.0, 1.0);
  const bool rests = in < 0.0 || in > tau_.seconds;
  const double w = rests ? 0.0 : tau_.d1(s), v = w * rate;
  const double a = rests ? 0.0 : tau_.d2(s) * rate * rate + w * slope;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    const double y2 = bend_[i] + f * third_[i], y1 = slope_[i] + f * (bend_[i] + 0.5 * f * third_[i]);
    out.x[i] = start_[i] + f * (slope_[i] + f * (0.5 * bend_[i] + f * third_[i] / 6.0));
    out.v[i] = y1 * v;
    out.a[i] = y2 * v * v + y1 * a;
  }
  out.place = place_ + f * way_;
  out.speed = way_ * v;
  return out;
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
    // What is no number keeps none.
    if (!(std::abs(y1 * v) <= l.velocity)) return false;
    if (!(std::abs(y2 * v * v + y1 * a) <= kShare * l.acceleration)) return false;
    if (!(std::abs(third_[i] * v * v * v + 3.0 * y2 * v * a + y1 * j) <= kShare * l.jerk)) return false;
  }
  return true;
}

bool Interval::bends(double in, double rate, double slope, const RateLimits& limits, double share,
                     double& least, double& largest) const noexcept {
  const double s = in / tau_.seconds, f = tau_.at(s), w = tau_.d1(s), w2 = tau_.d2(s), w3 = tau_.d3(s);
  const double v = w * rate, a = w2 * rate * rate + w * slope;
  const double j = w3 * rate * rate * rate + 3.0 * w2 * rate * slope;
  least = -std::numeric_limits<double>::infinity();
  largest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(limits.axes); ++i) {
    const AxisLimits& l = limits.limits[i];
    const double y2 = bend_[i] + f * third_[i], y1 = slope_[i] + f * (bend_[i] + 0.5 * f * third_[i]);
    if (!(std::abs(y1 * v) <= l.velocity)) return false;
    if (!(std::abs(y2 * v * v + y1 * a) <= share * l.acceleration)) return false;
    const double by_course = third_[i] * v * v * v + 3.0 * y2 * v * a + y1 * j;
    const double by_bend = y1 * w, room = share * l.jerk;
    if (by_bend == 0.0) {
      if (!(std::abs(by_course) <= room)) return false;
      continue;
    }
    const double middle = -by_course / by_bend, aside = room / std::abs(by_bend);
    least = std::max(least, middle - aside);
    largest = std::min(largest, middle + aside);
  }
  return least <= largest;
}

/// Goes on to another interval; both sides of the knots between.
template <class Change>
bool VerificationOf<Change>::keeps_at_knots(const CourseView& view, std::int64_t to, const RateLimits& limits,
                                            int& places) noexcept {
  const double p0 = change_.at(last_).passed, p1 = change_.at(t_).passed;
  while (interval_.knot() != to) {
    const bool on = to > interval_.knot();
    const std::int64_t begin = begin_of(view, interval_.knot());
    const Knot* knot = view.knot(on ? interval_.knot() : begin);
    if (knot == nullptr) return false;
    const double there = knot->t.since(from_);
    const double share = p1 != p0 ? std::clamp((there - p0) / (p1 - p0), 0.0, 1.0) : 0.0;
    const RateState rate = change_.at(last_ + share * (t_ - last_));
    places -= 2;
    if (!interval_.keeps(on ? interval_.seconds() : 0.0, rate, limits)) return false;
    if (!interval_.take(view, on ? next_of(view, interval_.knot()) : begin, limits)) return false;
    if (!interval_.keeps(on ? 0.0 : interval_.seconds(), rate, limits)) return false;
  }
  return true;
}

template <class Change>
void VerificationOf<Change>::begin(const Change& change, const LawTime& from, std::int64_t near_knot,
                                   double beyond) noexcept {
  change_ = change;
  beyond_ = beyond;
  from_ = from;
  before_ = near_knot;
  t_ = last_ = 0.0;
}

template <class Change>
Fit VerificationOf<Change>::go(const CourseView& view, const RateLimits& limits, int& places) noexcept {
  CoursePlace place(view);
  place.set_knot(before_);
  if (!interval_.take(view, before_, limits)) return Fit::unpublished;
  const double most = std::max({1.0, change_.r0, change_.r1}), next = spacing(change_);
  RateLimits kept = limits;
  if (most > 1.0) {  // more may lie between two places
    for (AxisLimits& axis : kept.limits) {
      axis.acceleration *= kAbove;
      axis.jerk *= kAbove;
    }
  }
  for (;; t_ = std::min(t_ + next, change_.seconds)) {
    if (places <= 0) return Fit::open;
    const RateState s = change_.at(t_);
    if (!(std::abs(s.rate) <= most + 1e-12)) return Fit::breaks;
    // A change that does not go through rest does not turn round on the way.
    if (change_.r0 * change_.r1 >= 0.0 && s.rate * (change_.r0 + change_.r1) < -1e-12) return Fit::breaks;
    if (change_.r0 * change_.r1 > 0.0 && dips(s, change_.r0, next)) return Fit::breaks;
    const LawTime at = from_.plus(s.passed);
    const double in = at.since(interval_.begin());
    if (!(in > 0.0 && in < kInside * interval_.seconds()) && !place.go(at)) return Fit::unpublished;
    --places;
    // Both sides of the knots on the way; a place at the very start may lie in the next interval.
    if (place.knot() != interval_.knot() && !keeps_at_knots(view, place.knot(), kept, places))
      return Fit::breaks;
    if (!interval_.keeps(at.since(interval_.begin()), s, kept)) return Fit::breaks;
    before_ = place.knot();
    last_ = t_;
    if (t_ < change_.seconds) continue;
    return reaches_stop(view, at, change_.r1, beyond_) ? Fit::fits : Fit::unpublished;
  }
}

template class VerificationOf<RateChange>;
template class VerificationOf<StopPlan>;

/// Who does not come to rest must reach the last stop that is known, and not be at it already by rounding.
bool reaches_stop(const CourseView& view, const LawTime& at, double r1, double beyond) noexcept {
  constexpr double kMore = 1.01;
  if (r1 == 0.0 || view.end() >= 0) return true;
  const StopHint guard = view.guard();
  const Knot* stop = view.knot(guard.knot);
  return guard.knot >= 0 && stop != nullptr && stop->t.since(at) >= kMore * r1 * beyond;
}

CoursePoint point_at(const CourseView& view, const LawTime& t, std::int64_t near,
                     const RateLimits& limits) noexcept {
  CoursePlace place(view);
  place.set_knot(near);
  Interval interval;
  if (!place.go(t) || !interval.take(view, place.knot(), limits)) return {};
  return interval.at(t.since(interval.begin()), 0.0, 0.0, limits.axes);
}

bool may_keep(const CourseView& view, const RateChange& change, const LawTime& from, std::int64_t near,
              const RateLimits& limits, int& places) noexcept {
  constexpr double kApart = 8.0;
  const double step = kApart * spacing(change);
  CoursePlace place(view);
  place.set_knot(near);
  Interval interval;
  for (double t = 0.0; t < change.seconds && places > 0; --places) {
    t = std::min(t + step, change.seconds);
    const RateState s = change.at(t);
    const LawTime at = from.plus(s.passed);
    const double in = at.since(interval.begin());
    const bool same = interval.knot() != 0 && in > 0.0 && in < kInside * interval.seconds();
    if (!same && !place.go(at)) return true;  // not for this to say
    if (interval.knot() != place.knot() && !interval.take(view, place.knot(), limits)) return true;
    if (!interval.keeps(at.since(interval.begin()), s, limits)) return false;
  }
  return true;
}

StopHint find_stop(const CourseView& view, std::int64_t knot, const StopHint& before,
                   const RateLimits& limits) {
  constexpr int kShorter = 4, kTries = 24, kPlaces = 1 << 20;
  constexpr double kStep = 0.85;
  const Knot* at = view.knot(knot);
  if (at == nullptr) return {};
  const std::int64_t near = std::max<std::int64_t>(1, knot);
  const auto may_fit = [&](double seconds, int power) {
    int places = kPlaces;
    return may_keep(view, {1.0, 0.0, 0.0, seconds, power}, at->t, near, limits, places);
  };
  const auto fits = [&](const StopHint& stop) {
    int places = kPlaces;
    Verification v;
    v.begin({1.0, 0.0, 0.0, stop.seconds, stop.power}, at->t, near);
    return v.go(view, limits, places) == Fit::fits;
  };
  // Shorter and shorter ones, looked at here and there; then the shortest that surely fits.
  std::array<StopHint, kShorter + 1> shorter;
  std::size_t count = 0;
  double seconds = before.seconds;
  int power = before.power;
  while (count < shorter.size() && (count == 0 || seconds > RateChange::kShortest)) {
    if (!may_fit(seconds, power)) {
      if (count == 0 || !may_fit(seconds, 5 - power)) break;
      power = 5 - power;
    }
    shorter[count++] = {seconds, power, knot};
    seconds *= kStep;
  }
  for (std::size_t n = count; n-- > 0;)
    if (fits(shorter[n])) return shorter[n];
  seconds = before.seconds;
  for (int n = 0; n < kTries && seconds < RateChange::kLongest; ++n, seconds *= RateChange::kLonger)
    for (const int p : {before.power, 5 - before.power})
      if (may_fit(seconds, p) && fits({seconds, p, knot})) return {seconds, p, knot};
  return {before.seconds, before.power, -1};
}

}  // namespace servogate::path
