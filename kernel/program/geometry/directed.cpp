// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/geometry/directed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "kernel/program/geometry/degrees.hpp"

namespace servogate::program {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kParallel = 1e-12;

Point plus(Point a, Point b, double factor) { return {a.x + factor * b.x, a.y + factor * b.y}; }
double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
double length(Point a) { return std::hypot(a.x, a.y); }

Directed line_of(Point along, Point through) {
  Directed line;
  line.along = along;
  line.height = dot(left_of(along), through);
  return line;
}

/// Where the centres of all circles of a radius lie that touch an element.
Directed locus(const Directed& element, double radius) {
  if (!element.circle) return shifted(element, radius);
  return circle_about(element.centre, std::abs(element.radius - radius));
}

/// Where a circle touches an element that it is known to touch.
Point touch(const Directed& element, const Directed& circle) {
  if (!element.circle) return foot(element, circle.centre);
  const double between = element.radius - circle.radius;
  if (std::abs(between) < 1e-9) return element.centre;
  const Point way = plus(circle.centre, element.centre, -1.0);
  return plus(element.centre, way, element.radius / between);
}

AtMostTwo<Point> line_and_line(const Directed& a, const Directed& b) {
  AtMostTwo<Point> points;
  const double turn = cross(a.along, b.along);
  if (std::abs(turn) < kParallel) return points;
  const Point on_a = foot(a, {0.0, 0.0});
  const double way = -distance_left(b, on_a) / dot(left_of(b.along), a.along);
  points.add(plus(on_a, a.along, way));
  return points;
}

AtMostTwo<Point> line_and_circle(const Directed& line, const Directed& circle, double slack) {
  AtMostTwo<Point> points;
  const double off = distance_left(line, circle.centre), r = std::abs(circle.radius);
  if (std::abs(off) > r + slack) return points;
  const double half = std::sqrt(std::max(0.0, r * r - off * off));
  const Point middle = foot(line, circle.centre);
  points.add(plus(middle, line.along, -half));
  points.add(plus(middle, line.along, half));
  return points;
}

AtMostTwo<Point> circle_and_circle(const Directed& a, const Directed& b, double slack) {
  AtMostTwo<Point> points;
  const Point way = plus(b.centre, a.centre, -1.0);
  const double d = length(way), ra = std::abs(a.radius), rb = std::abs(b.radius);
  if (d < kParallel || d > ra + rb + slack || d < std::abs(ra - rb) - slack) return points;
  const Point along{way.x / d, way.y / d};
  const double to_chord = (ra * ra - rb * rb + d * d) / (2.0 * d);
  const double half = std::sqrt(std::max(0.0, ra * ra - to_chord * to_chord));
  const Point middle = plus(a.centre, along, to_chord);
  points.add(plus(middle, left_of(along), half));
  points.add(plus(middle, left_of(along), -half));
  return points;
}

}  // namespace

Point left_of(Point direction) { return {-direction.y, direction.x}; }

Directed line_through(Point from, Point to) {
  const Point way = plus(to, from, -1.0);
  const double far = length(way);
  return line_of({way.x / far, way.y / far}, from);
}

Directed line_at(Point through, double angle_deg) {
  return line_of({cos_deg(angle_deg), sin_deg(angle_deg)}, through);
}

Directed circle_about(Point centre, double radius) {
  Directed circle;
  circle.circle = true;
  circle.centre = centre;
  circle.radius = radius;
  return circle;
}

Directed point_circle(Point point) { return circle_about(point, 0.0); }

Directed reversed(const Directed& element) {
  Directed other = element;
  other.along = {-element.along.x, -element.along.y};
  other.height = -element.height;
  other.radius = -element.radius;
  return other;
}

Directed shifted(const Directed& element, double left) {
  Directed other = element;
  other.height += left;
  other.radius -= left;
  return other;
}

double distance_left(const Directed& line, Point point) {
  return dot(left_of(line.along), point) - line.height;
}

Point foot(const Directed& line, Point point) {
  return plus(point, left_of(line.along), -distance_left(line, point));
}

double angle_of(const Directed& line) {
  const double angle = std::atan2(line.along.y, line.along.x) / kDegree;
  return angle <= -180.0 + 1e-9 ? 180.0 : angle;
}

Point direction_at(const Directed& element, Point point) {
  if (!element.circle) return element.along;
  const Point out = plus(point, element.centre, -1.0);
  const double far = std::copysign(std::max(length(out), 1e-300), element.radius);
  return {-out.y / far, out.x / far};
}

AtMostTwo<Point> common_points(const Directed& a, const Directed& b, double slack) {
  if (!a.circle && !b.circle) return line_and_line(a, b);
  if (a.circle && b.circle) return circle_and_circle(a, b, slack);
  return a.circle ? line_and_circle(b, a, slack) : line_and_circle(a, b, slack);
}

std::optional<Point> contact(const Directed& a, const Directed& b, double slack) {
  if (!a.circle && !b.circle) return std::nullopt;
  if (!a.circle || !b.circle) {
    const Directed &line = a.circle ? b : a, &circle = a.circle ? a : b;
    if (std::abs(distance_left(line, circle.centre) - circle.radius) > slack) return std::nullopt;
    return foot(line, circle.centre);
  }
  const double far = length(plus(b.centre, a.centre, -1.0));
  if (far < slack || std::abs(far - std::abs(a.radius - b.radius)) > slack) return std::nullopt;
  return touch(a, b);
}

AtMostTwo<Joining> joining_circles(const Directed& a, const Directed& b, double radius) {
  AtMostTwo<Joining> found;
  const AtMostTwo<Point> centres = common_points(locus(a, radius), locus(b, radius));
  for (int i = 0; i < centres.count; ++i) {
    Joining joining;
    joining.circle = circle_about(centres[i], radius);
    joining.first = touch(a, joining.circle);
    joining.second = touch(b, joining.circle);
    joining.sweep_deg = sweep(joining.first, joining.second, centres[i], radius > 0.0);
    found.add(joining);
  }
  if (found.count == 2 && std::abs(found[1].sweep_deg) < std::abs(found[0].sweep_deg))
    std::swap(found.items[0], found.items[1]);
  return found;
}

std::optional<Directed> common_tangent(const Directed& a, const Directed& b) {
  const Point way = plus(b.centre, a.centre, -1.0);
  const double far = length(way);
  const double sine = (b.radius - a.radius) / far;
  if (far < 1e-9 || std::abs(sine) > 1.0 + 1e-9) return std::nullopt;
  const double turn = std::asin(std::clamp(sine, -1.0, 1.0));
  const Point u{way.x / far, way.y / far};
  const Point along{u.x * std::cos(turn) + u.y * std::sin(turn), u.y * std::cos(turn) - u.x * std::sin(turn)};
  Directed line = line_of(along, a.centre);
  line.height -= a.radius;
  return line;
}

std::optional<Directed> circle_through(Point a, Point b, Point c) {
  const Point ab = plus(b, a, -1.0), ac = plus(c, a, -1.0);
  const double twice = 2.0 * cross(ab, ac);
  if (std::abs(twice) < 1e-9) return std::nullopt;
  const double b2 = dot(ab, ab), c2 = dot(ac, ac);
  const Point from_a{(ac.y * b2 - ab.y * c2) / twice, (ab.x * c2 - ac.x * b2) / twice};
  return circle_about(plus(a, from_a, 1.0), std::copysign(length(from_a), twice));
}

}  // namespace servogate::program
