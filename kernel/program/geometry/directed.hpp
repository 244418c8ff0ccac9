// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>

#include "kernel/program/geometry/circle.hpp"

/// Lines and circles with a direction, in a plane; mm. Two elements touch when they run the same way at the
/// point of contact. Source: specification A 22.3, B 1.3. Not for the cycle, though nothing here allocates.
namespace servogate::program {

/// A line by its unit direction, or a circle by its centre and radius: > 0 runs counter-clockwise. A circle
/// of radius 0 is a point.
struct Directed {
  bool circle = false;
  Point along{1.0, 0.0};  ///< of a line
  double height = 0.0;    ///< of a line: distance from the zero point, to its left
  Point centre;
  double radius = 0.0;
};

Directed line_through(Point from, Point to);
Directed line_at(Point through, double angle_deg);
Directed circle_about(Point centre, double radius);
Directed point_circle(Point point);
Directed reversed(const Directed& element);
/// Parallel or concentric, `left` > 0 to the left of its direction.
Directed shifted(const Directed& element, double left);

/// Of a point from a line, + to its left.
double distance_left(const Directed& line, Point point);
Point foot(const Directed& line, Point point);
double angle_of(const Directed& line);
/// Unit direction in which an element passes a point of it.
Point direction_at(const Directed& element, Point point);
Point left_of(Point direction);

/// At most two points or elements, in the order of the language of directed elements.
template <typename T>
struct AtMostTwo {
  std::array<T, 2> items{};
  int count = 0;
  void add(const T& item) { items[static_cast<std::size_t>(count++)] = item; }
  const T& operator[](int i) const { return items[static_cast<std::size_t>(i)]; }
};

/// Common points: a line meets its first one first; of two circles the first is left of the line from centre
/// to centre. Elements that miss one another by less than `slack` touch.
AtMostTwo<Point> common_points(const Directed& a, const Directed& b, double slack = 1e-6);

/// Where two elements touch and run the same way; none: they do not, by more than `slack`.
std::optional<Point> contact(const Directed& a, const Directed& b, double slack);

/// A circle that touches two elements, and where.
struct Joining {
  Directed circle;
  Point first, second;
  double sweep_deg = 0.0;  ///< from the first contact to the second, in its own sense
};
/// The circles of a radius that touch `a` and then `b` (points too); the one with the smaller arc first.
AtMostTwo<Joining> joining_circles(const Directed& a, const Directed& b, double radius);

/// The line that touches two circles (points too), from the first to the second.
std::optional<Directed> common_tangent(const Directed& a, const Directed& b);
/// The circle through three points, in their order.
std::optional<Directed> circle_through(Point a, Point b, Point c);

}  // namespace servogate::program
