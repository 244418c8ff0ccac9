// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {

/// The slot between path and axes: from the coordinates that elements are programmed in to those whose limits
/// hold and that the follower gives out. Planner and follower ask the same object, which outlives both; it
/// has no state that changes.
///
/// It is an affine map that keeps lengths: a turned or shifted frame, a mirror. Courses take their splines to
/// the axes with it, and bound/ fills what lies between the places that it looks at by rules that hold for
/// such maps. A curved one (face, cylinder, tool centre point) needs knots fitted on the axes, and denser
/// places in bound/.
class Transformation {
 public:
  virtual ~Transformation() = default;
  /// Takes a place with its three derivatives by the path parameter to the axes, over the first `axes`
  /// coordinates, in place. real-time safe.
  virtual void to_axes(PathPoint& place, int axes) const noexcept = 0;
};

/// The axes of the position alone. real-time safe.
Vector to_axes(const Transformation& transformation, const Vector& position, int axes) noexcept;
inline Vector to_axes(const Config& config, const Vector& position) noexcept {
  return to_axes(*config.transformation, position, config.axis_count);
}
/// The axes of a direction. real-time safe.
Vector turned_to_axes(const Transformation& transformation, const Vector& direction, int axes) noexcept;

}  // namespace servogate::path
