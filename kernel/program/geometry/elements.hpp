// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>

#include "kernel/program/geometry/directed.hpp"

namespace servogate::program {

/// A frame of the plane: shifted, then turned counter-clockwise.
struct PlaneFrame {
  Point origin;
  double angle_deg = 0.0;
};

/// The geometric elements that a program has defined, by number; programmed coordinates of the plane, mm, a
/// diameter axis as radius.
struct GeometricElements {
  std::map<int, PlaneFrame> origins;
  std::map<int, Point> points;
  std::map<int, Directed> lines;
  std::map<int, Directed> circles;
};

}  // namespace servogate::program
