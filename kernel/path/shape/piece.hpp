// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "kernel/path/shape/element.hpp"

namespace servogate::path {

/// Position and derivatives with respect to the path parameter at one point.
struct PathPoint {
  Vector x{}, d1{}, d2{}, d3{};
};

/// One piece of the geometry that is driven: a line, an arc (circle, helix; a radius that changes by a
/// rounding error in the program makes it a spiral, so that both ends are exact) or a blend. The parameter
/// sigma runs from 0 to `length`; on lines and arcs it is the length of the vector over mm and degrees, on
/// blends close to it. Position, first and second derivative are
/// continuous from piece to piece.
struct Piece {
  enum class Shape : std::uint8_t { line, arc, blend };
  Shape shape = Shape::line;
  std::uint8_t axis1 = 0, axis2 = 1;  ///< plane of an arc
  bool rapid = false;
  double length = 0.0;  ///< of the parameter
  double offset = 0.0;  ///< parameter of the whole element or blend at the piece's start
  double full = 0.0;    ///< parameter length of the whole
  /// Line: x = c0 + c1 s (from the end backwards in the second half: c5 = end). Arc: the same for the axes
  /// outside the plane. Blend: x = c0 + c1 u + ... + c5 u^5, u = (offset + s) / full.
  Vector c0{}, c1{}, c2{}, c3{}, c4{}, c5{};
  double center1 = 0.0, center2 = 0.0, radius = 0.0, radius_slope = 0.0, angle = 0.0, omega = 0.0;
  double start = 0.0;  ///< parameter at the piece's start within its span; filled by the law
  double time = 0.0;   ///< running sum of the shortest times, s; filled by the law
  double rest = 0.0;   ///< path length from the piece's end to the end of the element `tag`
  Tag tag;             ///< element in motion
  Vector target{};     ///< end point of the element `tag`
};

/// Euclidean length over the first `n` axes. real-time safe.
double norm(const Vector& v, int n) noexcept;

/// Position only, in piece coordinates 0 <= s <= length. real-time safe.
Vector position(const Piece& piece, double s, int axes) noexcept;

/// Position and three derivatives. real-time safe.
PathPoint evaluate(const Piece& piece, double s, int axes) noexcept;

/// Control at the place `s` of the uniform cubic spline along a line or an arc whose knots lie `spacing` of
/// the parameter apart: the spline is exact at the knots. Goes on beyond the ends of the piece.
Vector spline_control(const Piece& piece, double s, double spacing, int axes);

/// From the begin of one piece to the end of another one further on, as a straight of the way between them, in
/// the element of the last one.
Piece joined(const Piece& first, const Piece& last, int axes);

/// Part [from, from + length] of a piece.
Piece part(const Piece& piece, double from, double length);

/// Why an element cannot be driven.
enum class Flaw : std::uint8_t {
  none,
  not_finite,   ///< a coordinate, feed or tolerance is not a number or out of any machine (|x| > 1e7)
  no_feed,      ///< feed <= 0
  wrong_plane,  ///< axis1, axis2 equal, rotary or beyond axis_count
  no_radius,    ///< the arc's radius is below 1e-6 mm
  radius,       ///< those of its start and its end differ by more than 0.011 mm
  sweep,        ///< the sweep does not lead to the end point
};

/// Whole geometry of an element that starts at `from`; length 0 when nothing moves.
struct Shaped {
  Flaw flaw = Flaw::none;
  Piece piece;
};
Shaped shape(const Config& config, const Vector& from, const Element& element);

/// A blend from the last `trim` of `before` to the first `trim` of `after` (whole elements), with position,
/// first and second derivative continuous at both ends. The distance to the programmed path (Fréchet, all
/// axes alike) is at most `tolerance`, and `trim` at most half of either element. Nothing when the elements
/// turn back (more than 170 degrees) or the tolerance leaves no room.
struct Blend {
  double trim = 0.0;
  double deviation = 0.0;
  Piece piece;
};
std::optional<Blend> blend(const Piece& before, const Piece& after, double tolerance, int axes);

/// True when the two join with continuous tangent and curvature as they are.
bool joins_smoothly(const Piece& before, const Piece& after, int axes);

/// Change of direction from the end of `before` to the start of `after`, radians, 0 - pi.
double turn(const Piece& before, const Piece& after, int axes);

}  // namespace servogate::path
