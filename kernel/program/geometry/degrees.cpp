// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/geometry/degrees.hpp"

#include <cmath>
#include <numbers>

namespace servogate::program {
namespace {

/// Angle brought to 0-360 degrees.
double reduced(double degrees) {
  const double r = std::fmod(degrees, 360.0);
  return r < 0.0 ? r + 360.0 : r;
}

}  // namespace

double sin_deg(double degrees) {
  const double a = reduced(degrees);
  if (a == 0.0 || a == 180.0) return 0.0;
  if (a == 90.0) return 1.0;
  if (a == 270.0) return -1.0;
  if (a == 30.0 || a == 150.0) return 0.5;
  if (a == 210.0 || a == 330.0) return -0.5;
  return std::sin(a * std::numbers::pi / 180.0);
}

double cos_deg(double degrees) { return sin_deg(reduced(degrees) + 90.0); }

double tan_deg(double degrees) {
  if (std::fmod(std::abs(degrees), 180.0) == 45.0) return degrees > 0.0 ? 1.0 : -1.0;
  if (std::fmod(std::abs(degrees), 180.0) == 135.0) return degrees > 0.0 ? -1.0 : 1.0;
  const double c = cos_deg(degrees);
  return c == 0.0 ? std::nan("") : sin_deg(degrees) / c;
}

}  // namespace servogate::program
