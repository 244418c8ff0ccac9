// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"

namespace servogate::report {

/// How well measurements of one place agree.
struct Repeatability {
  double mean = 0.0;
  double spread = 0.0;     ///< from the least to the greatest
  double deviation = 0.0;  ///< standard deviation of the sample (n - 1); 0 of a single one
};
/// All 0 where there are none.
Repeatability repeatability(std::span<const double> places);

/// A touch of a probe as one of the axes that were moved has seen it; machine coordinates, mm or degrees.
struct Touch {
  int axis = 0;
  int direction = 1;  ///< in which the axis moved: 1, -1
  double feed_mm_min = 0.0;
  double at = 0.0;                               ///< of the axis
  std::array<double, image::kMaxAxes> beside{};  ///< where the others were; 0 of the axis itself
};

/// Touches of the same place: of one axis, in one direction, at one feed, with all axes within 0.1 mm
/// (degrees) of those of the first one.
struct TouchGroup {
  int axis = 0;
  std::string letter;
  std::string unit = "mm";
  bool diameter = false;  ///< people read diameters; all values here are of the radius
  int direction = 1;
  double feed_mm_min = 0.0;
  std::vector<double> places = {};  ///< in the order of the touches
};
/// In the order of their first touches; without letters.
std::vector<TouchGroup> grouped(std::span<const Touch> touches);

}  // namespace servogate::report
