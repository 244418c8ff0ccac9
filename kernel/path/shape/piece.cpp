// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/piece.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::path {
namespace {

constexpr double kFarthest = 1e7;  // mm, degrees
constexpr double kRadiusMismatch =
    0.011;  // mm: what rounding in a program may leave (interpreters warn at 0.01)
constexpr double kTwoPi = 2.0 * std::numbers::pi;

bool finite(const Config& config, const Element& e) {
  for (int i = 0; i < config.axis_count; ++i)
    if (!(std::abs(e.to[i]) <= kFarthest)) return false;
  const Transition& t = e.transition;
  return std::isfinite(t.tolerance) && std::isfinite(t.erf) && std::isfinite(t.max_angle_deg) &&
         (e.kind == Element::Kind::rapid || std::isfinite(e.feed));
}

/// Length of a move: of the vector over millimetres and degrees.
double parameter_length(const Config& config, const Vector& delta, double along_arc) {
  return std::hypot(norm(delta, config.axis_count), along_arc);
}

void straight_axes(const Config& config, Piece& piece, const Vector& from, const Vector& to) {
  for (int i = 0; i < config.axis_count; ++i) {
    piece.c0[i] = from[i];
    piece.c1[i] = (to[i] - from[i]) / piece.length;
    piece.c5[i] = to[i];
  }
}

Flaw shape_arc(const Config& config, const Vector& from, const Element& e, Piece& piece) {
  const int p = e.axis1, q = e.axis2;
  if (p >= config.axis_count || q >= config.axis_count || p == q || config.rotary[p] || config.rotary[q])
    return Flaw::wrong_plane;
  if (!(std::abs(e.center1) <= kFarthest) || !(std::abs(e.center2) <= kFarthest) ||
      !(std::abs(e.sweep_deg) <= 360.0 * 10000.0))
    return Flaw::not_finite;
  const double r0 = std::hypot(from[p] - e.center1, from[q] - e.center2);
  const double r1 = std::hypot(e.to[p] - e.center1, e.to[q] - e.center2);
  if (std::abs(r1 - r0) > kRadiusMismatch) return Flaw::radius;
  if (r0 < 1e-6 || r1 < 1e-6) return Flaw::no_radius;
  const double a0 = std::atan2(from[q] - e.center2, from[p] - e.center1);
  const double a1 = std::atan2(e.to[q] - e.center2, e.to[p] - e.center1);
  const double wanted = e.sweep_deg / 180.0 * std::numbers::pi;
  const double sweep = (a1 - a0) + kTwoPi * std::round((wanted - (a1 - a0)) / kTwoPi);
  if (std::abs(sweep - wanted) * r0 > 2.0 * kRadiusMismatch) return Flaw::sweep;

  Vector delta{};
  for (int i = 0; i < config.axis_count; ++i) delta[i] = (i == p || i == q) ? 0.0 : e.to[i] - from[i];
  piece.shape = Piece::Shape::arc;
  piece.axis1 = e.axis1;
  piece.axis2 = e.axis2;
  piece.length = parameter_length(config, delta, 0.5 * (r0 + r1) * sweep);
  if (piece.length < 1e-9) {
    piece.length = 0.0;
    return Flaw::none;
  }
  straight_axes(config, piece, from, e.to);
  piece.center1 = e.center1;
  piece.center2 = e.center2;
  piece.radius = r0;
  piece.radius_slope = (r1 - r0) / piece.length;
  piece.angle = a0;
  piece.omega = sweep / piece.length;
  return Flaw::none;
}

/// c0 + c1 s, from the nearer end, so that both ends are exact.
inline double straight(const Piece& p, int i, double s) {
  return s + s <= p.length ? p.c0[i] + p.c1[i] * s : p.c5[i] - p.c1[i] * (p.length - s);
}

}  // namespace

double norm(const Vector& v, int n) noexcept {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += v[i] * v[i];
  return std::sqrt(sum);
}

Vector position(const Piece& p, double s, int axes) noexcept {
  Vector x{};
  if (p.shape == Piece::Shape::blend) {
    const double u = (s + p.offset) / p.full;
    for (int i = 0; i < axes; ++i)
      x[i] = p.c0[i] + u * (p.c1[i] + u * (p.c2[i] + u * (p.c3[i] + u * (p.c4[i] + u * p.c5[i]))));
    return x;
  }
  for (int i = 0; i < axes; ++i) x[i] = straight(p, i, s);
  if (p.shape == Piece::Shape::arc && s > 0.0 && s < p.length) {
    const double angle = p.angle + p.omega * s, r = p.radius + p.radius_slope * s;
    x[p.axis1] = p.center1 + r * std::cos(angle);
    x[p.axis2] = p.center2 + r * std::sin(angle);
  }
  return x;
}

PathPoint evaluate(const Piece& p, double s, int axes) noexcept {
  PathPoint at;
  if (p.shape == Piece::Shape::blend) {
    const double h = 1.0 / p.full, u = (s + p.offset) * h;
    for (int i = 0; i < axes; ++i) {
      const double c2 = p.c2[i], c3 = p.c3[i], c4 = p.c4[i], c5 = p.c5[i];
      at.x[i] = p.c0[i] + u * (p.c1[i] + u * (c2 + u * (c3 + u * (c4 + u * c5))));
      at.d1[i] = h * (p.c1[i] + u * (2 * c2 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5))));
      at.d2[i] = h * h * (2 * c2 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5)));
      at.d3[i] = h * h * h * (6 * c3 + u * (24 * c4 + u * 60 * c5));
    }
    return at;
  }
  for (int i = 0; i < axes; ++i) {
    at.x[i] = straight(p, i, s);
    at.d1[i] = p.c1[i];
  }
  if (p.shape == Piece::Shape::arc) {
    const double angle = p.angle + p.omega * s, w = p.omega;
    const double r = p.radius + p.radius_slope * s, k = p.radius_slope;
    const double c = std::cos(angle), n = std::sin(angle);
    const int i = p.axis1, j = p.axis2;
    if (s > 0.0 && s < p.length) {
      at.x[i] = p.center1 + r * c;
      at.x[j] = p.center2 + r * n;
    }
    at.d1[i] = k * c - r * w * n;
    at.d1[j] = k * n + r * w * c;
    at.d2[i] = -2 * k * w * n - r * w * w * c;
    at.d2[j] = 2 * k * w * c - r * w * w * n;
    at.d3[i] = -3 * k * w * w * c + r * w * w * w * n;
    at.d3[j] = -3 * k * w * w * n - r * w * w * w * c;
  }
  return at;
}

Vector spline_control(const Piece& p, double s, double spacing, int axes) {
  Vector x{};
  for (int i = 0; i < axes; ++i) x[i] = straight(p, i, s);
  if (p.shape != Piece::Shape::arc) return x;
  // (c before + 4 c + c behind) / 6 lies on the circle.
  const double out = 3.0 / (2.0 + std::cos(p.omega * spacing));
  const double angle = p.angle + p.omega * s, r = out * (p.radius + p.radius_slope * s);
  x[p.axis1] = p.center1 + r * std::cos(angle);
  x[p.axis2] = p.center2 + r * std::sin(angle);
  return x;
}

Piece joined(const Piece& first, const Piece& last, int axes) {
  Piece out = last;
  out.shape = Piece::Shape::line;
  out.start = first.start;
  out.length = out.full = last.start + last.length - first.start;
  out.offset = 0.0;
  out.c0 = position(first, 0.0, axes);
  out.c5 = position(last, last.length, axes);
  out.c1 = {};
  if (out.length > 0.0)
    for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i)
      out.c1[i] = (out.c5[i] - out.c0[i]) / out.length;
  return out;
}

Piece part(const Piece& piece, double from, double length) {
  Piece p = piece;
  p.offset = piece.offset + from;
  p.length = length;
  p.rest = piece.length - (from + length);
  if (piece.shape == Piece::Shape::blend) return p;
  if (from > 0.0) p.c0 = position(piece, from, kMaxAxes);
  if (from + length < piece.length) p.c5 = position(piece, from + length, kMaxAxes);
  p.angle = piece.angle + piece.omega * from;
  p.radius = piece.radius + piece.radius_slope * from;
  return p;
}

Shaped shape(const Config& config, const Vector& from, const Element& e) {
  Shaped out;
  Piece& piece = out.piece;
  const bool arc = e.kind == Element::Kind::arc;
  if (!finite(config, e)) {
    out.flaw = Flaw::not_finite;
  } else if (e.kind != Element::Kind::rapid && !(e.feed > 0.0)) {
    out.flaw = Flaw::no_feed;
  } else if (arc) {
    out.flaw = shape_arc(config, from, e, piece);
  } else {
    Vector delta{};
    for (int i = 0; i < config.axis_count; ++i) delta[i] = e.to[i] - from[i];
    piece.length = norm(delta, config.axis_count) < 1e-9 ? 0.0 : parameter_length(config, delta, 0.0);
    if (piece.length > 0.0) straight_axes(config, piece, from, e.to);
  }
  piece.full = piece.length;
  piece.rapid = e.kind == Element::Kind::rapid;
  piece.tag = e.tag;
  piece.target = e.to;
  return out;
}

}  // namespace servogate::path
