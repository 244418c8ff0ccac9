// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "kernel/path/law/pipeline.hpp"
#include "kernel/path/shape/gather.hpp"
#include "tests/path/rig/frechet.hpp"
#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {

/// A run with the two controls before it and the cruise behind it.
struct Stage {
  std::array<Vector, 2> before{};
  std::vector<Knot> knots;
  std::optional<Cruise> cruise;  ///< else it ends at rest
  double seconds() const;
};

/// What the planner published of a program.
struct Course {
  std::vector<Stage> runs;
  Pipeline::Counts counts;
  std::size_t most_kept = 0;  ///< legs and knots inside of the planner at any time
  double seconds() const;
};

/// Plans a program; `portion` elements between two calls of work().
Course plan(const RandomProgram& program, int portion = 1 << 30, double reserve = 0.01);

/// Set-points each `period` s, run by run, from the published knots alone: written from the definition of a
/// knot, with nothing of the planner's arithmetic.
Polyline sampled(const Course& course, const Vector& start, int axes, double period);

/// The worst of each limit by finite differences over `period`, as a ratio of the limit.
struct Reached {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
};
Reached reached(const Polyline& points, const Config& config, double period);

/// Empty when the published course keeps every law: all limits by 0.1 % (sampled each 1 ms and each 0.37 ms),
/// the tolerance, and the end point to 1 nm. Otherwise what is wrong.
std::string verdict(const Course& course, const RandomProgram& program, Reached* most = nullptr);

}  // namespace servogate::path::test
