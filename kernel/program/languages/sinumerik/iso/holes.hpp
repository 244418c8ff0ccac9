// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

namespace servogate::program::sinumerik::iso {

/// One hole of a drilling cycle in force: programmed coordinates, mm, of X of turning radii.
struct Hole {
  int g = 81;
  std::string name;
  int column = 0;
  int axis = 2;
  double initial = 0.0, level = 0.0, depth = 0.0;
  double step = 0.0;  ///< Q: of one pass, or the shift of a boring tool
  double dwell_s = 0.0;
  int repeats = 1;
};

// milling_holes.cpp, holes.cpp: from the initial level to R or beside it, at the depth and back to R
void milled_hole(Execution& run, const Hole& hole);
void turned_hole(Execution& run, const Hole& hole);

/// By how much a tool that has left the hole goes on at rapid above its last bottom (ZSFR10).
double reentry(const Execution& run, double depth);
/// F as a lead, or F over S.
double tapping_lead(const Execution& run, const Hole& hole);

}  // namespace servogate::program::sinumerik::iso
