// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "kernel/program/geometry/circle.hpp"

namespace servogate::program {

class Execution;

/// One element of a contour that is turned; x is the coordinate along the first axis of the plane, y along
/// the second one. Programmed coordinates, mm; of a diameter axis radii.
struct TurnedElement {
  Point end;
  bool arc = false, rapid = false;
  Point centre;
  double sweep_deg = 0.0;  ///< + from the first axis to the second
};

/// A contour from where the tool stands; its first element leads to it.
struct Roughing {
  std::string name;  ///< as the language writes it
  int column = 0;
  std::vector<TurnedElement> contour;
  Point start;              ///< where the tool stands, and ends
  bool along_first = true;  ///< passes run along the first axis
  double depth = 0.0;       ///< of one pass, no sign
  double retract = 0.0;     ///< no sign
  Point allowance;          ///< the contour of the passes lies so far beside
  bool pockets = false;     ///< the contour may go back towards the depth
};

/// How a contour cannot be worked; empty: it can. The axis along which it turns back: 0 the first, 1 the
/// second.
struct RoughingFault {
  bool turns_back = false;
  int axis = 0;
};
RoughingFault check_roughing(const Roughing& work);

/// The tool returns to its start at rapid, across the contour and then along it: the start lies beside the
/// whole contour, or the way back would pass through the work.
struct StartInside {
  bool inside = false;
  int axis = 0;        ///< 0 the first, 1 the second
  double reach = 0.0;  ///< of the contour along this axis, towards the start
};
StartInside check_start(const Roughing& work);

/// Passes down to the contour with its allowance, then once along it, and back to where the tool stood.
/// Throws where there are too many.
void rough_contour(Execution& run, const Roughing& work);

/// Once along the contour, shifted, with its own rapids.
void follow_contour(Execution& run, const std::vector<TurnedElement>& contour, Point shift);

}  // namespace servogate::program
