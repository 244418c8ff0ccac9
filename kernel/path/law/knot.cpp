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

}  // namespace servogate::path
