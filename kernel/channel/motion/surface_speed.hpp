// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::channel {

/// Speed of the spindle for a cutting speed in m/min at a radius in mm (G96), n = 1000 v / (pi D), rpm;
/// `limit_rpm` 0: none. real-time safe.
inline double surface_rpm(double m_per_min, double radius_mm, double limit_rpm) noexcept {
  constexpr double kSmallestRadius = 1e-3;  // mm
  const double rpm =
      m_per_min * 1000.0 / (2.0 * std::numbers::pi * std::max(std::abs(radius_mm), kSmallestRadius));
  return limit_rpm > 0.0 ? std::min(rpm, limit_rpm) : rpm;
}

}  // namespace servogate::channel
