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
  acceleration_.resize((2 * n + 1) * axes);
  jerk_.resize(n * 3 * axes);
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
    acceleration_[2 * at - static_cast<std::size_t>(a)] = {
        {s * 0.5 * (d2 - d1 * i1), s * 0.5 * (d2 + d1 * i1), 0.0}};
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
    for (int place = 0; place < 3; ++place) {
      // Jerk by sqrt(b): x''' b + 3/2 x'' b' + 1/2 x' b''.
      const double f = 0.5 * place, e2 = d2 + f * step_ * d3,
                   e1 = d1 + f * step_ * (d2 + 0.5 * f * step_ * d3);
      const double slope[3] = {-(1.0 - f) * i1, (1.0 - 2.0 * f) * i1, f * i1};
      const double bend[3] = {i2, -2.0 * i2, i2};
      Row& row = jerk_[static_cast<std::size_t>((k * 3 + place) * axes_ + a)];
      for (int q = 0; q < 3; ++q)
        row.f[q] = s * (d3 * kAt[place][q] + 1.5 * e2 * slope[q] + 0.5 * e1 * bend[q]);
      if (place != 1) continue;
      Row& middle = acceleration_[static_cast<std::size_t>((2 * k + 1) * axes_ + a)];
      for (int q = 0; q < 3; ++q) middle.f[q] = by_acceleration * (e2 * kAt[1][q] + 0.5 * e1 * slope[q]);
    }
  }
}

void SpeedLaw::flat_levels(std::vector<double>& levels, std::vector<double>& slopes, int intervals) {
  slopes.assign(cap_.size(), 1.0);
  levels.assign(cap_.begin(), cap_.end());
  constexpr double kSlopeShare = 0.2;
  const double ones[3] = {1.0, 1.0, 1.0};
  for (int k = 0; k <= intervals_; ++k) {
    double& level = levels[static_cast<std::size_t>(k)];
    for (int a = 0; a < axes_; ++a) {
      const Row& row = acceleration_[static_cast<std::size_t>(2 * k * axes_ + a)];
      level = std::min(level, 1.0 / std::max(1e-12, std::abs(row.f[0] + row.f[1])));
      double& slope = slopes[static_cast<std::size_t>(k)];
      slope = std::min(slope, kSlopeShare / std::max(1e-12, 0.5 * std::abs(row.f[1] - row.f[0])));
    }
    if (k == intervals_) break;
    double jerk = 1e-12;
    const Row* row = &jerk_[static_cast<std::size_t>(k * 3 * axes_)];
    for (int q = 0; q < 3 * axes_; ++q, ++row) jerk = std::max(jerk, std::abs(at(row->f, ones)));
    const double by_jerk = 1.0 / std::cbrt(jerk * jerk);
    level = std::min(level, by_jerk);
    levels[static_cast<std::size_t>(k) + 1] = std::min(levels[static_cast<std::size_t>(k) + 1], by_jerk);
  }
  intervals_ = intervals;
}

Tightness SpeedLaw::as_they_are() const {
  const auto n = static_cast<std::size_t>(intervals_);
  return {std::vector<double>(2 * n + 1, 1.0), std::vector<double>(n, 1.0), std::vector<double>(n + 1, 1.0)};
}

/// Shares of the limits that beta uses.
void SpeedLaw::uses(const std::vector<double>& beta, Tightness& out) const {
  out = as_they_are();
  const auto axes = static_cast<std::size_t>(axes_);
  for (std::size_t k = 0; k < out.cap.size(); ++k) {
    const double* q = &beta[k];
    out.cap[k] = at_knot(q) / cap_[k];
    double knot = 0.0, middle = 0.0, jerk = 0.0;
    const Row* row = &acceleration_[2 * k * axes];
    for (std::size_t a = 0; a < axes; ++a)
      knot = std::max(knot, std::abs(row[a].f[0] * q[0] + row[a].f[1] * q[1]));
    out.acceleration[2 * k] = knot;
    if (k == out.jerk.size()) break;
    for (std::size_t a = axes; a < 2 * axes; ++a) middle = std::max(middle, std::abs(at(row[a].f, q)));
    out.acceleration[2 * k + 1] = middle;
    row = &jerk_[k * 3 * axes];
    for (const auto& weights : kAt)
      for (std::size_t a = 0; a < axes; ++a, ++row)
        jerk = std::max(jerk, std::abs(at(row->f, q)) * std::sqrt(at(weights, q)));
    out.jerk[k] = jerk;
  }
}

void SpeedLaw::scale(const Tightness& by) {
  const auto axes = static_cast<std::size_t>(axes_);
  const auto rows = [](Row* row, std::size_t count, double factor) {
    for (std::size_t i = 0; i < count; ++i)
      for (double& f : row[i].f) f *= factor;
  };
  for (std::size_t k = 0; k < by.cap.size(); ++k) cap_[k] /= by.cap[k];
  for (std::size_t k = 0; k < by.acceleration.size(); ++k)
    rows(&acceleration_[k * axes], axes, by.acceleration[k]);
  for (std::size_t k = 0; k < by.jerk.size(); ++k) rows(&jerk_[k * 3 * axes], 3 * axes, by.jerk[k]);
}

}  // namespace servogate::path
