// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vector>

namespace servogate::bench {

inline constexpr int kCourseAxes = 3;
using Triple = std::array<double, kCourseAxes>;

/// A place of a fixed path and its first three derivatives by the path's parameter s.
struct Place {
  double s = 0.0;
  Triple d1{}, d2{}, d3{};
  double cap = 0.0;  ///< largest ds/dt that the feed allows
};

/// A path from rest to rest, as places whose s rises.
using Course = std::vector<Place>;

/// What no axis exceeds; the same for all places.
struct Limits {
  Triple velocity{}, acceleration{}, jerk{};
};

/// Positions from 0 to `length`: `spacing` apart, and ever closer towards the rests at both ends, where the
/// speed goes with the cube root of the square.
std::vector<double> graded(double length, double spacing);

struct Optimum {
  double seconds = 0.0;
  double gap = 0.0;  ///< the optimum of the grid is at most this many seconds less; with jerk: the local one
  bool converged = false;
};

/// The least time in which the course can be driven, found without anything of the kernel's. Assumptions:
/// - The path is fixed: what another path within the tolerance would gain is not in it.
/// - b = (ds/dt)^2 is piecewise linear between the places; limits hold at the places. The denser they are,
/// the
///   better; the error of rest goes with the cube root of the first step.
/// - Without jerk limits the problem is convex: `seconds - gap` is a lower bound for any law on this grid.
/// - With jerk limits it is not, as they hold for a product with ds/dt. The law that is found keeps them and
/// no
///   small change makes it faster; a different one might.
/// Method: logarithmic barrier, and Newton on b with the curvature of limits left out.
Optimum fastest(const Course& course, const Limits& limits, bool with_jerk);

}  // namespace servogate::bench
