// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/bound/bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

/// Share of acceleration and jerk that stays for speeding up and slowing down where the path is curved.
struct Share {
  double acceleration, jerk;
};
constexpr Share kShare{0.2, 0.3};

/// Bounds of the derivatives of one axis around one place of the piece, with that axis' limits:
///   d1 v <= V,  d2 v^2 + d1 a <= A,  d3 v^3 + 3 d2 v a + d1 j <= J.
struct Row {
  double d1, d2, d3;
  const AxisLimits* limits;
};

struct Rows {
  static constexpr int kMost = 50 * kMaxAxes;
  std::array<Row, kMost> rows;
  int count = 0;
  void add(double d1, double d2, double d3, const AxisLimits& limits) {
    if (d1 + d2 + d3 > 0.0 && count < kMost) rows[count++] = {d1, d2, d3, &limits};
  }
  const Row* begin() const { return rows.data(); }
  const Row* end() const { return rows.data() + count; }
};

/// Position and derivatives on the axes.
PathPoint on_axes(const Config& config, const Piece& piece, double s) {
  PathPoint at = evaluate(piece, s, config.axis_count);
  config.transformation->to_axes(at, config.axis_count);
  return at;
}

void sample_line(const Config& config, const Piece& p, Rows& rows) {
  const PathPoint at = on_axes(config, p, 0.0);
  for (int i = 0; i < config.axis_count; ++i) rows.add(std::abs(at.d1[i]), 0.0, 0.0, config.limits[i]);
}

/// On an arc every combination of the derivatives is a sinusoid of the angle, so that between two samples it
/// is at most 1 / cos(half the step) higher.
void sample_arc(const Config& config, const Piece& p, Rows& rows) {
  const double sweep = std::min(std::abs(p.omega) * p.length, 6.3);
  const int steps = std::clamp(static_cast<int>(std::ceil(sweep / 0.131)), 1, 48);
  const double factor = 1.0 / std::cos(0.5 * sweep / steps);
  const double span = sweep / std::abs(p.omega);
  PathPoint even{p.c0, p.c1};  // what moves linearly with the angle
  even.d1[p.axis1] = even.d1[p.axis2] = 0.0;
  config.transformation->to_axes(even, config.axis_count);
  for (int k = 0; k <= steps; ++k) {
    const PathPoint at = on_axes(config, p, span * k / steps);
    for (int i = 0; i < config.axis_count; ++i) {
      if (k > 0 && at.d2[i] == 0.0 && at.d3[i] == 0.0) continue;  // the same everywhere
      rows.add(factor * std::abs(at.d1[i] - even.d1[i]) + std::abs(even.d1[i]), factor * std::abs(at.d2[i]),
               factor * std::abs(at.d3[i]), config.limits[i]);
    }
  }
}

/// On a blend a function f between samples h apart is at most h^2 / 8 max|f''| higher than at them; for the
/// third derivative of a quintic that maximum is its constant fifth, for the lower ones it follows from those
/// above.
void sample_blend(const Config& config, const Piece& p, Rows& rows) {
  constexpr int kSteps = 12;
  const int n = config.axis_count;
  const double h = p.length / kSteps, e = h * h / 8.0;
  std::array<PathPoint, kSteps + 1> at;
  for (int k = 0; k <= kSteps; ++k) at[k] = on_axes(config, p, h * k);
  const double full5 = std::pow(p.full, 5), slope4 = 24.0 / std::pow(p.full, 4);
  PathPoint higher{p.c0, p.c4, {}, p.c5};  // the map takes any derivative as it takes the first
  for (int i = 0; i < n; ++i) higher.d2[i] = p.c4[i] + 5.0 * p.c5[i];
  config.transformation->to_axes(higher, n);
  for (int i = 0; i < n; ++i) {
    const double fifth = 120.0 * std::abs(higher.d3[i]) / full5;
    const double fourth = slope4 * std::max(std::abs(higher.d1[i]), std::abs(higher.d2[i]));
    double third = 0.0;
    for (const PathPoint& point : at) third = std::max(third, std::abs(point.d3[i]));
    third += e * fifth;
    for (const PathPoint& point : at)
      rows.add(std::abs(point.d1[i]) + e * third, std::abs(point.d2[i]) + e * fourth,
               std::abs(point.d3[i]) + e * fifth, config.limits[i]);
  }
}

double fastest(const Rows& rows, double cap, const Share& share) {
  double v = cap;
  for (const Row& r : rows) {
    if (r.d1 > 0.0) v = std::min(v, r.limits->velocity / r.d1);
    if (r.d2 * v * v > (1.0 - share.acceleration) * r.limits->acceleration)
      v = std::sqrt((1.0 - share.acceleration) * r.limits->acceleration / r.d2);
    if (r.d3 * v * v * v > (1.0 - share.jerk) * r.limits->jerk)
      v = std::cbrt((1.0 - share.jerk) * r.limits->jerk / r.d3);
  }
  return v;
}

double jerk_left(const Rows& rows, double v, double a) {
  double j = 1e300;
  for (const Row& r : rows) {
    const double left = r.limits->jerk - r.d3 * v * v * v - 3.0 * r.d2 * v * a;
    if (left <= 0.0) return 0.0;
    if (r.d1 > 0.0) j = std::min(j, left / r.d1);
  }
  return j;
}

/// Largest speed of the vector over mm and degrees for a parameter speed of 1.
double path_rate(const Config& config, const Piece& p) {
  if (p.shape != Piece::Shape::blend)
    return p.shape == Piece::Shape::arc ? std::hypot(1.0, p.radius_slope) : 1.0;
  // The derivative of a Bézier curve stays in the hull of its control differences.
  double worst = 0.0;
  const auto control = [&](int i, int k) {
    const double c1 = p.c1[i], c2 = p.c2[i], c3 = p.c3[i], c4 = p.c4[i];
    switch (k) {
      case 0:
        return c1;
      case 1:
        return c1 + c2 / 2.0;
      case 2:
        return c1 + c2 + c3 / 2.0;
      case 3:
        return c1 + 1.5 * c2 + 1.5 * c3 + c4;
      default:
        return c1 + 2 * c2 + 3 * c3 + 4 * c4 + 5 * p.c5[i];
    }
  };
  for (int k = 0; k < 5; ++k) {
    double square = 0.0;
    for (int i = 0; i < config.axis_count; ++i) square += control(i, k) * control(i, k);
    worst = std::max(worst, std::sqrt(square) / p.full);
  }
  return std::max(1.0, worst);
}

}  // namespace

Box box(const Config& config, const Piece& piece, double velocity_cap) {
  Rows rows;
  if (piece.shape == Piece::Shape::line) {
    sample_line(config, piece, rows);
  } else if (piece.shape == Piece::Shape::arc) {
    sample_arc(config, piece, rows);
  } else {
    sample_blend(config, piece, rows);
  }
  Box out;
  out.velocity = fastest(rows, velocity_cap, kShare);
  double most = 1e300;
  const double v = out.velocity;
  for (const Row& r : rows) {
    if (r.d1 > 0.0) most = std::min(most, (r.limits->acceleration - r.d2 * v * v) / r.d1);
    if (r.d2 > 0.0) most = std::min(most, 0.9 * (r.limits->jerk - r.d3 * v * v * v) / (3.0 * r.d2 * v));
  }
  // Acceleration and jerk share what is left: take the pair that reaches the speed first.
  double best = 1e300;
  for (double a = most; a > 1e-3 * most; a *= 0.75) {
    const double j = jerk_left(rows, v, a);
    if (j <= 0.0) continue;
    const double time = v / a + a / j;
    if (time > best) break;
    best = time;
    out.acceleration = a;
    out.jerk = j;
  }
  return out;
}

Bound bound(const Config& config, const Piece& piece, const Element& e) {
  Bound out;
  const bool rapid = e.kind == Element::Kind::rapid;
  const double turns = rapid ? 0.0 : e.revolutions;
  const bool locked = !rapid && e.lock.kind != Lock::Kind::none;
  out.feed.speed = rapid ? std::numeric_limits<double>::infinity() : e.feed / path_rate(config, piece);
  if (locked) {
    const double begin = e.lock.per_turn_at(piece.offset),
                 end = e.lock.per_turn_at(piece.offset + piece.length);
    out.feed.lock = e.lock;
    if (piece.shape == Piece::Shape::line)
      out.feed.lock.per_turn = begin;
    else
      out.feed.lock.change = 0.0;
    out.feed.speed = std::max(begin, end) * turns / path_rate(config, piece);
  }
  if (turns > 0.0) out.feed.per_turn = out.feed.speed / turns;
  out.feed.turns = turns;
  out.feed.rapid = rapid;
  // What a line may accelerate does not depend on its speed: its master may bring it to the axes' limits.
  const bool free = locked && piece.shape == Piece::Shape::line;
  out.box = box(config, piece,
                free ? std::numeric_limits<double>::infinity() : out.feed.speed * config.largest_override);
  out.feed.speed = std::min(out.feed.speed, out.box.velocity);
  return out;
}

}  // namespace servogate::path
