// SPDX-License-Identifier: Apache-2.0
#include "bench/path/optimum/course.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::bench {
namespace {

/// An element as the program means it: a line, or an arc in the plane of two axes.
struct Leg {
  Leg(const Triple& begin, const path::Element& element) : from(begin), e(element) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kCourseAxes; ++k) {
      const bool in_plane = arc() && (k == e.axis1 || k == e.axis2);
      const double d = in_plane ? 0.0 : e.to[k] - from[k];
      sum += d * d;
    }
    if (arc()) sum += std::pow(radius() * sweep(), 2);
    length = std::sqrt(sum);
  }

  Triple at(double s) const {
    const double share = length > 0.0 ? s / length : 1.0;
    Triple x;
    for (std::size_t k = 0; k < kCourseAxes; ++k) x[k] = from[k] + share * (e.to[k] - from[k]);
    if (!arc()) return x;
    const double angle = std::atan2(from[e.axis2] - e.center2, from[e.axis1] - e.center1) + share * sweep();
    x[e.axis1] = e.center1 + radius() * std::cos(angle);
    x[e.axis2] = e.center2 + radius() * std::sin(angle);
    return x;
  }

  bool arc() const { return e.kind == path::Element::Kind::arc; }
  double sweep() const { return e.sweep_deg / 180.0 * std::numbers::pi; }
  double radius() const { return std::hypot(from[e.axis1] - e.center1, from[e.axis2] - e.center2); }

  Triple from;
  path::Element e;
  double length = 0.0;
};

}  // namespace

double length_of(const Program& program) {
  Triple from{};
  double length = 0.0;
  for (const path::Element& e : program) {
    length += Leg(from, e).length;
    for (std::size_t k = 0; k < kCourseAxes; ++k) from[k] = e.to[k];
  }
  return length;
}

Line programmed(const Program& program, double step) {
  Triple from{};
  std::vector<Leg> legs;
  for (const path::Element& e : program) {
    legs.push_back(Leg(from, e));
    for (std::size_t k = 0; k < kCourseAxes; ++k) from[k] = e.to[k];
  }
  const double length = length_of(program);
  const auto count = static_cast<std::size_t>(std::ceil(length / step));
  Line out;
  out.step = length / static_cast<double>(count);
  std::size_t n = 0;
  double before = 0.0;
  for (std::size_t i = 0; i <= count; ++i) {
    const double s = out.step * static_cast<double>(i);
    while (n + 1 < legs.size() && s > before + legs[n].length) before += legs[n++].length;
    out.points.push_back(legs[n].at(std::min(s - before, legs[n].length)));
  }
  return out;
}

Limits limits_of(const path::Config& config) {
  Limits out;
  for (int i = 0; i < kCourseAxes; ++i) {
    out.velocity[i] = config.limits[i].velocity;
    out.acceleration[i] = config.limits[i].acceleration;
    out.jerk[i] = config.limits[i].jerk;
  }
  return out;
}

}  // namespace servogate::bench
