// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/judge.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/law/knot.hpp"

namespace servogate::path {

double interval_time(std::span<const double> beta, std::size_t k, double step) {
  // Gauss's rule with three places.
  constexpr double kPlace[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr double kWeight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  double sum = 0.0;
  for (int q = 0; q < 3; ++q) {
    const double f = kPlace[q], g = 1.0 - f;
    const double b = 0.5 * (g * g * beta[k] + (1.0 + 2.0 * f * g) * beta[k + 1] + f * f * beta[k + 2]);
    sum += kWeight[q] / std::sqrt(b);
  }
  return sum * step;
}

namespace {

/// One interval, at so many places.
Excess used(const SpeedProblem& p, std::size_t k, int places) {
  const double i1 = 1.0 / p.step, i2 = i1 * i1;
  const auto axes = static_cast<std::size_t>(p.axes);
  const double* q = &p.beta[k];
  const Quintic tau = Quintic::between(interval_time(p.beta, k, p.step), std::sqrt(0.5 * (q[0] + q[1])) * i1,
                                       0.5 * (q[1] - q[0]) * i2, std::sqrt(0.5 * (q[1] + q[2])) * i1,
                                       0.5 * (q[2] - q[1]) * i2);
  Excess most;
  for (int place = 0; place <= places; ++place) {
    const double s = static_cast<double>(place) / places;
    const double f = tau.at(s), w = tau.d1(s), w2 = tau.d2(s), w3 = tau.d3(s);
    for (std::size_t a = 0; a < axes; ++a) {
      const auto axis = static_cast<std::size_t>(p.axis[a]);
      const AxisLimits &here = (*p.bounds[k].limits)[axis], &next = (*p.bounds[k + 1].limits)[axis];
      const double* c = &p.controls[k * axes + a];
      const double c0 = c[0], c1 = c[axes], c2 = c[2 * axes], c3 = c[3 * axes];
      const double y3 = c3 - 3.0 * c2 + 3.0 * c1 - c0, bend = c0 - 2.0 * c1 + c2;
      const double y2 = bend + f * y3, y1 = 0.5 * (c2 - c0) + f * (bend + 0.5 * f * y3);
      most.velocity = std::max(most.velocity, std::abs(y1 * w) / std::min(here.velocity, next.velocity));
      most.acceleration = std::max(
          most.acceleration, std::abs(y2 * w * w + y1 * w2) / std::min(here.acceleration, next.acceleration));
      most.jerk = std::max(
          most.jerk, std::abs(y3 * w * w * w + 3.0 * y2 * w * w2 + y1 * w3) / std::min(here.jerk, next.jerk));
    }
  }
  return most;
}

}  // namespace

void judge(const SpeedProblem& p, std::size_t intervals, std::vector<Excess>& excess) {
  constexpr int kPlaces = 8, kClose = 32;
  constexpr double kNear = 0.993;
  excess.resize(intervals);
  for (std::size_t k = 0; k < intervals; ++k) {
    excess[k] = used(p, k, kPlaces);
    if (excess[k].most() > kNear) excess[k] = used(p, k, kClose);
  }
}

}  // namespace servogate::path
