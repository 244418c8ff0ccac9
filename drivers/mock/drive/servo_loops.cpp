// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/servo_loops.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/mock/drive/plant.hpp"

namespace servogate::mock {
namespace {

constexpr double kDefaultVelocityBandwidth = 600.0;  // rad/s

}  // namespace

double total_inertia_of(const PlantConfig& c) noexcept {
  return c.inertia_kg_m2 + std::max(0.0, c.load_inertia_kg_m2);
}

double velocity_gain_of(const PlantConfig& c) noexcept {
  return c.velocity_gain > 0.0 ? c.velocity_gain : total_inertia_of(c) * kDefaultVelocityBandwidth;
}

// Bilinear, s = k (z - 1) / (z + 1) with k that keeps the centre.
void NotchFilter::set(double hz, double depth, double step) noexcept {
  if (hz == hz_ && depth == depth_) return;
  hz_ = hz;
  depth_ = depth;
  b0_ = 1.0;
  b1_ = b2_ = a1_ = a2_ = 0.0;
  if (!(hz > 0.0) || hz * step > 0.45) return;
  const double w = 2.0 * std::numbers::pi * hz, k = w / std::tan(0.5 * w * step);
  const double a0 = k * k + 2.0 * w * k + w * w;
  b0_ = (k * k + 2.0 * depth * w * k + w * w) / a0;
  b1_ = a1_ = 2.0 * (w * w - k * k) / a0;
  b2_ = (k * k - 2.0 * depth * w * k + w * w) / a0;
  a2_ = (k * k - 2.0 * w * k + w * w) / a0;
}

double NotchFilter::operator()(double x) noexcept {
  const double y = b0_ * x + z1_;
  z1_ = b1_ * x - a1_ * y + z2_;
  z2_ = b2_ * x - a2_ * y;
  return y;
}

}  // namespace servogate::mock
