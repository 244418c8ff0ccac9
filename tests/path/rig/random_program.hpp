// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <random>
#include <vector>

#include "kernel/path/shape/element.hpp"

namespace servogate::path::test {

/// A machine and a program made from a seed.
struct RandomProgram {
  Config config;
  Vector start{};
  std::vector<Element> elements;
  double tolerance = 0.0;  ///< the one contour tolerance of all elements
};

struct ProgramShape {
  int elements = 8;
  bool rotary = true;  ///< some machines have rotary axes
  bool stops = true;   ///< some exact stops and rapids
};

/// Lines, arcs and helices of all sizes, tangential and sharp joins, feeds from creeping to beyond the
/// limits.
RandomProgram random_program(std::uint64_t seed, const ProgramShape& shape);

/// A three-axis mill: 500 mm/s, 1000 mm/s2, 10 000 mm/s3.
Config mill();
Element line_to(double x, double y, double z, double feed, double tolerance = 0.01);
/// In the plane of the first two axes.
Element arc_to(double x, double y, double cx, double cy, double sweep_deg, double feed,
               double tolerance = 0.01);

}  // namespace servogate::path::test
