// SPDX-License-Identifier: Apache-2.0
// The limits of a law as rows on its beta.
#include <algorithm>
#include <cmath>

#include "kernel/path/law/speed.hpp"
#include "kernel/path/law/speed_places.hpp"

namespace servogate::path {
namespace {

constexpr double kLargestCap = 1e8;

}  // namespace

void SpeedLaw::prepare(const SpeedProblem& p) {
  axes_ = p.axes;
  step_ = p.step;
  intervals_ = static_cast<int>(p.controls.size()) / p.axes - 3;
  const auto n = static_cast<std::size_t>(intervals_), axes = static_cast<std::size_t>(axes_);
  cap_.resize(n + 1);
  d1_.resize((n + 1) * axes);
  d2_.resize((n + 1) * axes);
  const std::size_t knots = whole_pairs();
  rows_.assign(knots / 2 * axes, Rows{});
  sums_.resize(knots / 2);
  q_.resize(knots + 2);
  for (auto* v : {&knot_, &middle_, &knot_root_, &middle_root_, &knot_half_, &middle_half_, &room_})
    v->assign(knots + 1, 1.0);
  for (int k = 0; k <= intervals_; ++k) prepare_knot(p, k);
  for (int k = 0; k < intervals_; ++k) prepare_interval(p, k);
}

void SpeedLaw::prepare_knot(const SpeedProblem& p, int k) {
  const double i1 = 1.0 / step_, i2 = i1 * i1;
  const KnotBound& bound = p.bounds[static_cast<std::size_t>(k)];
  double along = 0.0, cap = kLargestCap;
  for (int a = 0; a < axes_; ++a) {
    const int axis = p.axis[static_cast<std::size_t>(a)];
    const AxisLimits& limits = (*bound.limits)[static_cast<std::size_t>(axis)];
    const double* c = &p.controls[static_cast<std::size_t>(k * axes_ + a)];
    const double d1 = 0.5 * i1 * (c[2 * axes_] - c[0]);
    const double d2 = i2 * (c[2 * axes_] - 2.0 * c[axes_] + c[0]);
    along += d1 * d1;
    const double v = p.share * limits.velocity, s = 1.0 / (p.share * limits.acceleration);
    cap = std::min(cap, v * v / std::max(1e-30, d1 * d1));
    const auto at = static_cast<std::size_t>(k * axes_ + a);
    d1_[at] = d1;
    d2_[at] = d2;
    set_factor(a, kKnot, k, s * 0.5 * (d2 - d1 * i1));
    set_factor(a, kKnot + 1, k, s * 0.5 * (d2 + d1 * i1));
  }
  if (std::isfinite(bound.feed)) cap = std::min(cap, bound.feed * bound.feed / std::max(1e-30, along));
  cap_[static_cast<std::size_t>(k)] = cap;
}

void SpeedLaw::prepare_interval(const SpeedProblem& p, int k) {
  const double i1 = 1.0 / step_, i2 = i1 * i1, i3 = i2 * i1;
  for (int a = 0; a < axes_; ++a) {
    const auto axis = static_cast<std::size_t>(p.axis[static_cast<std::size_t>(a)]);
    const AxisLimits& here = (*p.bounds[static_cast<std::size_t>(k)].limits)[axis];
    const AxisLimits& next = (*p.bounds[static_cast<std::size_t>(k + 1)].limits)[axis];
    const double* c = &p.controls[static_cast<std::size_t>(k * axes_ + a)];
    const double d3 = i3 * (c[3 * axes_] - 3.0 * c[2 * axes_] + 3.0 * c[axes_] - c[0]);
    const double s = 1.0 / (p.share * std::min(here.jerk, next.jerk));
    const double by_acceleration = 1.0 / (p.share * std::min(here.acceleration, next.acceleration));
    const double d1 = d1_[static_cast<std::size_t>(k * axes_ + a)];
    const double d2 = d2_[static_cast<std::size_t>(k * axes_ + a)];
    for (std::size_t place = 0; place < 3; ++place) {
      // Jerk by sqrt(b): x''' b + 3/2 x'' b' + 1/2 x' b''.
      const double f = 0.5 * static_cast<double>(place), e2 = d2 + f * step_ * d3,
                   e1 = d1 + f * step_ * (d2 + 0.5 * f * step_ * d3);
      const double slope[3] = {-(1.0 - f) * i1, (1.0 - 2.0 * f) * i1, f * i1};
      const double bend[3] = {i2, -2.0 * i2, i2};
      for (std::size_t q = 0; q < 3; ++q)
        set_factor(a, kJerk + 3 * place + q, k,
                   s * (d3 * kAt[place][q] + 1.5 * e2 * slope[q] + 0.5 * e1 * bend[q]));
      if (place != 1) continue;
      for (std::size_t q = 0; q < 3; ++q)
        set_factor(a, kMiddle + q, k, by_acceleration * (e2 * kAt[1][q] + 0.5 * e1 * slope[q]));
    }
  }
}

/// No limits behind the last knot.
void SpeedLaw::clear_behind() {
  const int knots = static_cast<int>(rows_.size()) / axes_ * 2;
  for (int a = 0; a < axes_; ++a)
    for (int k = intervals_; k < knots; ++k)
      for (std::size_t which = k == intervals_ ? kMiddle : kKnot; which < kFactors; ++which)
        set_factor(a, which, k, 0.0);
}

void SpeedLaw::flat_levels(std::vector<double>& levels, std::vector<double>& slopes, int intervals) {
  slopes.assign(cap_.size(), 1.0);
  levels.assign(cap_.begin(), cap_.end());
  constexpr double kSlopeShare = 0.2;
  const double ones[3] = {1.0, 1.0, 1.0};
  for (int k = 0; k <= intervals_; ++k) {
    double& level = levels[static_cast<std::size_t>(k)];
    for (int a = 0; a < axes_; ++a) {
      const double f0 = factor(a, kKnot, k), f1 = factor(a, kKnot + 1, k);
      level = std::min(level, 1.0 / std::max(1e-12, std::abs(f0 + f1)));
      double& slope = slopes[static_cast<std::size_t>(k)];
      slope = std::min(slope, kSlopeShare / std::max(1e-12, 0.5 * std::abs(f1 - f0)));
    }
    if (k == intervals_) break;
    double jerk = 1e-12;
    for (int a = 0; a < axes_; ++a)
      for (std::size_t place = 0; place < 3; ++place)
        jerk = std::max(jerk, std::abs(use(a, kJerk + 3 * place, k, ones)));
    const double by_jerk = 1.0 / std::cbrt(jerk * jerk);
    level = std::min(level, by_jerk);
    levels[static_cast<std::size_t>(k) + 1] = std::min(levels[static_cast<std::size_t>(k) + 1], by_jerk);
  }
  intervals_ = intervals;
  clear_behind();
}

Tightness SpeedLaw::as_they_are() const {
  const auto n = static_cast<std::size_t>(intervals_);
  return {std::vector<double>(2 * n + 1, 1.0), std::vector<double>(n, 1.0), std::vector<double>(n + 1, 1.0)};
}

/// Shares of the limits that beta uses.
void SpeedLaw::uses(const std::vector<double>& beta, Tightness& out) const {
  out = as_they_are();
  for (int k = 0; k <= intervals_; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double* q = &beta[i];
    out.cap[i] = at_knot(q) / cap_[i];
    double knot = 0.0, middle = 0.0, jerk = 0.0;
    for (int a = 0; a < axes_; ++a) knot = std::max(knot, std::abs(use_at_knot(a, k, q)));
    out.acceleration[2 * i] = knot;
    if (k == intervals_) break;
    for (int a = 0; a < axes_; ++a) middle = std::max(middle, std::abs(use(a, kMiddle, k, q)));
    out.acceleration[2 * i + 1] = middle;
    for (std::size_t place = 0; place < 3; ++place) {
      const double root = std::sqrt(at(kAt[place], q));
      for (int a = 0; a < axes_; ++a) jerk = std::max(jerk, std::abs(use(a, kJerk + 3 * place, k, q)) * root);
    }
    out.jerk[i] = jerk;
  }
}

void SpeedLaw::scale(const Tightness& by) {
  for (std::size_t k = 0; k < by.cap.size(); ++k) cap_[k] /= by.cap[k];
  for (int k = 0; k <= intervals_; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool interval = k < intervals_;
    for (int a = 0; a < axes_; ++a)
      for (std::size_t which = 0; which < (interval ? kFactors : kMiddle); ++which)
        set_factor(a, which, k,
                   factor(a, which, k) * (which < kMiddle ? by.acceleration[2 * i]
                                          : which < kJerk ? by.acceleration[2 * i + 1]
                                                          : by.jerk[i]));
  }
}

}  // namespace servogate::path
