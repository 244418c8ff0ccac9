// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/shape/piece.hpp"

namespace servogate::path {

/// The slot between path and axes: from the coordinates that elements are programmed in to those whose limits
/// hold and that the follower gives out. Planner and follower ask the same object, which outlives both; it
/// has no state that changes.
///
/// bound/ looks at places along a piece and fills what lies between by rules that hold for affine maps (a
/// turned or shifted frame, a mirror). A curved one (face, cylinder, tool centre point) needs denser places
/// there; nothing else in the room minds.
class Transformation {
 public:
  virtual ~Transformation() = default;
  /// Takes a place with its three derivatives by the path parameter to the axes, over the first `axes`
  /// coordinates, in place. real-time safe.
  virtual void to_axes(PathPoint& place, int axes) const noexcept = 0;
};

/// The axes of the position alone. real-time safe.
Vector to_axes(const Config& config, const Vector& position) noexcept;

}  // namespace servogate::path
