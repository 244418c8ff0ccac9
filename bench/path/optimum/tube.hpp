// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "bench/path/optimum/optimum.hpp"

namespace servogate::bench {

/// A path in even steps of its parameter, ends included; corners need not be among them.
struct Line {
  double step = 0.0;
  std::vector<Triple> points;
};

/// The path within `tolerance` of the programmed one, point by point (so that their Fréchet distance is no
/// more), that has the least sum of squares of its third derivative, from end to end. A path that can be had,
/// and so no bound: it tells how much of a time better smoothing can save at least. Method: logarithmic
/// barrier and Newton on the points.
Line smoothest(const Line& programmed, double tolerance);

/// Its places for fastest(), derivatives by differences; at the ends those of the third point. `feed`: along
/// the path.
Course course_of(const Line& line, double feed);

}  // namespace servogate::bench
