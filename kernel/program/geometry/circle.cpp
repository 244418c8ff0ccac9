// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/geometry/circle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::program {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSamePoint = 1e-7;  ///< mm

}  // namespace

double sweep(Point start, Point end, Point centre, bool counter_clockwise) {
  const double full = counter_clockwise ? 360.0 : -360.0;
  if (std::hypot(end.x - start.x, end.y - start.y) <= kSamePoint) return full;
  const double ax = start.x - centre.x, ay = start.y - centre.y, bx = end.x - centre.x, by = end.y - centre.y;
  const double angle = std::atan2(ax * by - ay * bx, ax * bx + ay * by) / kDegree;
  if (angle == 0.0) return full;
  if (counter_clockwise) return angle < 0.0 ? angle + 360.0 : angle;
  return angle > 0.0 ? angle - 360.0 : angle;
}

bool centre_by_radius(Point start, Point end, double radius, bool counter_clockwise, Point& centre) {
  const double dx = end.x - start.x, dy = end.y - start.y;
  const double chord = std::hypot(dx, dy), r = std::abs(radius);
  if (chord > 2.0 * r + kRadiusTolerance) return false;
  const double height = std::sqrt(std::max(0.0, r * r - chord * chord / 4.0));
  const double side = (counter_clockwise == (radius > 0.0)) ? 1.0 : -1.0;
  centre = {(start.x + end.x) / 2.0 - side * height * dy / chord,
            (start.y + end.y) / 2.0 + side * height * dx / chord};
  return true;
}

Box extent(Point start, Point end, Point centre, double sweep_deg) {
  Box box{{std::min(start.x, end.x), std::min(start.y, end.y)},
          {std::max(start.x, end.x), std::max(start.y, end.y)}};
  const double radius = std::max(std::hypot(start.x - centre.x, start.y - centre.y),
                                 std::hypot(end.x - centre.x, end.y - centre.y));
  double first = std::atan2(start.y - centre.y, start.x - centre.x) / kDegree;
  double last = first + sweep_deg;
  if (last < first) std::swap(first, last);
  for (int quarter = -4; quarter <= 4; ++quarter) {
    const double angle = 90.0 * quarter;
    const double turns = std::ceil((first - angle) / 360.0);
    if (angle + 360.0 * turns > last) continue;
    const int q = ((quarter % 4) + 4) % 4;
    if (q == 0) box.high.x = std::max(box.high.x, centre.x + radius);
    if (q == 1) box.high.y = std::max(box.high.y, centre.y + radius);
    if (q == 2) box.low.x = std::min(box.low.x, centre.x - radius);
    if (q == 3) box.low.y = std::min(box.low.y, centre.y - radius);
  }
  return box;
}

}  // namespace servogate::program
