// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {

/// A curve through points, with continuous curvature: a cubic of the length of the chords. At each end the
/// curvature is 0, or the direction is given. Source: specification A 11.
class Spline {
 public:
  /// At least two points, none equal to the one before it; `axes` coordinates of each count. `first`, `last`:
  /// unit directions.
  Spline(std::vector<Position> points, std::size_t axes, const std::optional<Position>& first,
         const std::optional<Position>& last);

  std::size_t spans() const { return points_.size() - 1; }
  /// At a share of a span, 0 to 1.
  Position at(std::size_t span, double share) const;
  /// Equal parts of a span whose chords lie no further than `tolerance` from the curve.
  int parts(std::size_t span, double tolerance) const;

 private:
  std::vector<Position> points_;
  std::vector<Position> bends_;  ///< second derivatives by the length
  std::vector<double> lengths_;  ///< of the chords
  std::size_t axes_;
};

}  // namespace servogate::program
