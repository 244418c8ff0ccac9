// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::program {

/// A point of the plane, machine coordinates in mm.
struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// Largest difference of the radii at both ends of an arc that is still executed, mm. Source: specification
/// A 9.2.
inline constexpr double kRadiusTolerance = 0.01;

/// Angle from start to end about the centre, degrees, in the wanted sense: > 0 counter-clockwise. Equal
/// points give a full circle.
double sweep(Point start, Point end, Point centre, bool counter_clockwise);

/// Centre of the arc of a radius between two points: `radius` > 0 the arc up to 180 degrees, < 0 the larger
/// one. A radius too short by no more than the tolerance gives the half circle. False: too short by more.
bool centre_by_radius(Point start, Point end, double radius, bool counter_clockwise, Point& centre);

/// Largest and smallest coordinates of an arc.
struct Box {
  Point low;
  Point high;
};
Box extent(Point start, Point end, Point centre, double sweep_deg);

}  // namespace servogate::program
