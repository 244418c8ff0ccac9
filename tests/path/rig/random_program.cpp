// SPDX-License-Identifier: Apache-2.0
#include "tests/path/rig/random_program.hpp"

#include <cmath>
#include <numbers>

namespace servogate::path::test {
namespace {

class Maker {
 public:
  Maker(std::uint64_t seed, const ProgramShape& shape) : random_(seed), shape_(shape) {}

  RandomProgram make() {
    Config& c = out_.config;
    c.axis_count = chance(0.6) ? 3 : 1 + static_cast<int>(uniform(1.0, 8.999));
    const bool equal = chance(0.3);
    for (int i = 0; i < c.axis_count; ++i) {
      c.limits[i] = equal && i > 0
                        ? c.limits[0]
                        : AxisLimits{logarithmic(20, 800), logarithmic(200, 6000), logarithmic(3000, 2e5)};
      c.rotary[i] = shape_.rotary && i >= 3 && chance(0.4);
      out_.start[i] = uniform(-100, 100);
    }
    out_.tolerance = logarithmic(0.002, 0.1);
    at_ = out_.start;
    heading_ = uniform(0, 6.28);
    const double size = logarithmic(0.02, 20.0), feed = logarithmic(5, 600);
    for (int k = 0; k < shape_.elements; ++k) {
      if (chance(0.1)) {
        short_lines(size * logarithmic(0.01, 0.3), feed);
        continue;
      }
      Element e = chance(0.3) && c.axis_count >= 2 ? arc(size * logarithmic(0.3, 3))
                                                   : line(size * logarithmic(0.1, 5));
      e.feed = chance(0.7) ? feed : logarithmic(5, 600);
      e.transition = transition();
      e.tag.line = static_cast<int>(out_.elements.size()) + 1;
      if (shape_.stops && chance(0.05) && e.kind == Element::Kind::line) e.kind = Element::Kind::rapid;
      out_.elements.push_back(e);
      at_ = e.to;
    }
    return out_;
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  double logarithmic(double a, double b) { return a * std::pow(b / a, uniform(0, 1)); }
  bool chance(double p) { return uniform(0, 1) < p; }

  Transition transition() {
    Transition t;
    t.tolerance = out_.tolerance;
    t.continuation = Continuation::continuous;
    if (chance(0.2)) {
      t.continuation = Continuation::corner_limited;
      t.erf = logarithmic(0.002, 0.1);
      t.max_angle_deg = uniform(20, 180);
    }
    if (shape_.stops && chance(0.1)) t.continuation = Continuation::exact_stop;
    t.confirm = t.continuation == Continuation::exact_stop && chance(0.5);
    return t;
  }

  void other_axes(Element& e, double size, int from) {
    for (int i = from; i < out_.config.axis_count; ++i)
      if (chance(0.3)) e.to[i] += uniform(-size, size) * (out_.config.rotary[i] ? 3.0 : 1.0);
  }

  Element line(double size) {
    Element e;
    e.to = at_;
    if (chance(0.7)) heading_ += uniform(-0.5, 0.5);
    if (chance(0.15)) heading_ += uniform(-3.2, 3.2);
    const bool turning_only = out_.config.axis_count > 3 && chance(0.1);
    if (!turning_only) {
      e.to[0] += size * std::cos(heading_);
      if (out_.config.axis_count > 1) e.to[1] += size * std::sin(heading_);
    }
    other_axes(e, size, turning_only ? 3 : 2);
    return e;
  }

  /// What a CAM system makes of a curve.
  void short_lines(double size, double feed) {
    const double bend = logarithmic(1e-4, 0.3) * (chance(0.5) ? 1 : -1), noise = logarithmic(1e-5, 0.1);
    const bool corner = chance(0.2);
    for (int n = static_cast<int>(logarithmic(3, 80)); n > 0; --n) {
      heading_ += bend + uniform(-noise, noise) + (corner && n == 3 ? 0.6 : 0.0);
      Element e;
      e.to = at_;
      const double l = size * uniform(0.3, 1.7);
      e.to[0] += l * std::cos(heading_);
      if (out_.config.axis_count > 1) e.to[1] += l * std::sin(heading_);
      if (out_.config.axis_count > 2 && chance(0.5)) e.to[2] += l * uniform(-noise, noise);
      e.feed = feed;
      e.transition = {Continuation::continuous, out_.tolerance, 0.0, 180.0, false};
      e.tag.line = static_cast<int>(out_.elements.size()) + 1;
      out_.elements.push_back(e);
      at_ = e.to;
    }
  }

  Element arc(double size) {
    Element e;
    e.kind = Element::Kind::arc;
    const double side = chance(0.5) ? 1.0 : -1.0, sweep = side * logarithmic(0.05, chance(0.1) ? 12.6 : 3.2);
    if (chance(0.4)) heading_ += uniform(-1.5, 1.5);  // otherwise tangential
    const double nx = -std::sin(heading_) * side, ny = std::cos(heading_) * side;
    e.to = at_;
    e.center1 = at_[0] + size * nx;
    e.center2 = at_[1] + size * ny;
    const double begin = std::atan2(-ny, -nx);
    e.to[0] = e.center1 + size * std::cos(begin + sweep);
    e.to[1] = e.center2 + size * std::sin(begin + sweep);
    e.sweep_deg = sweep * 180.0 / std::numbers::pi;
    heading_ += sweep;
    if (chance(0.4)) other_axes(e, size, 2);
    return e;
  }

  std::mt19937_64 random_;
  ProgramShape shape_;
  RandomProgram out_;
  Vector at_{};
  double heading_ = 0.0;
};

}  // namespace

RandomProgram random_program(std::uint64_t seed, const ProgramShape& shape) {
  return Maker(seed, shape).make();
}

Config mill() {
  Config config;
  for (int i = 0; i < 3; ++i) config.limits[i] = {500.0, 1000.0, 10000.0};
  return config;
}

Element line_to(double x, double y, double z, double feed, double tolerance) {
  Element e;
  e.to = {x, y, z};
  e.feed = feed;
  e.transition = {Continuation::continuous, tolerance, 0.0, 180.0, false};
  return e;
}

Element arc_to(double x, double y, double cx, double cy, double sweep_deg, double feed, double tolerance) {
  Element e = line_to(x, y, 0.0, feed, tolerance);
  e.kind = Element::Kind::arc;
  e.center1 = cx;
  e.center2 = cy;
  e.sweep_deg = sweep_deg;
  return e;
}

}  // namespace servogate::path::test
