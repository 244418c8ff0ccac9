// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "bench/path/optimum/tube.hpp"
#include "bench/path/works.hpp"

namespace servogate::bench {

/// The path that the kernel's shape room makes of a program, from rest to rest. All elements have one feed.
struct Shaped {
  std::vector<Course> courses;  ///< one between two stops
  double length = 0.0;
};
Shaped shape_of(const path::Config& config, const Program& program);

/// The programmed path in even steps, about so long.
Line programmed(const Program& program, double step);

Limits limits_of(const path::Config& config);

}  // namespace servogate::bench
