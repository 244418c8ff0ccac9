// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/knot.hpp"

#include <algorithm>

namespace servogate::path {

Vector Stretch::position(double t, int axes) const noexcept {
  const double f = std::clamp(tau_.at(std::clamp(t / tau_.seconds, 0.0, 1.0)), 0.0, 1.0), g = 1.0 - f;
  const double a = g * g * g / 6.0, d = f * f * f / 6.0, b = (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0;
  const double c = 1.0 - a - b - d;
  Vector x{};
  for (int i = 0; i < axes; ++i)
    x[i] = a * knots_[0]->control[i] + b * knots_[1]->control[i] + c * knots_[2]->control[i] +
           d * knots_[3]->control[i];
  return x;
}

CoursePoint Stretch::at(double t, int axes) const noexcept {
  const double s = std::clamp(t / tau_.seconds, 0.0, 1.0), f = tau_.at(s);
  const double w = tau_.d1(s), w2 = tau_.d2(s), w3 = tau_.d3(s);
  CoursePoint out;
  out.x = position(t, axes);
  for (int i = 0; i < axes; ++i) {
    const double p0 = knots_[0]->control[i], p1 = knots_[1]->control[i], p2 = knots_[2]->control[i],
                 p3 = knots_[3]->control[i];
    const double y3 = p3 - 3.0 * p2 + 3.0 * p1 - p0, bend = p0 - 2.0 * p1 + p2;
    const double y2 = bend + f * y3, y1 = 0.5 * (p2 - p0) + f * (bend + 0.5 * f * y3);
    out.d1[i] = y1 * w;
    out.d2[i] = y2 * w * w + y1 * w2;
    out.d3[i] = y3 * w * w * w + 3.0 * y2 * w * w2 + y1 * w3;
  }
  return out;
}

}  // namespace servogate::path
