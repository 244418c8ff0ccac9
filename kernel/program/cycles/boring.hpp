// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::program {

class Execution;

/// How chips are broken on the way: a pass, a dwell, and so much back.
struct ChipBreaking {
  bool on = false, last = false;  ///< `last`: behind the last pass, too
  double pass = 0.0, back = 0.0;  ///< mm, no sign
  double dwell_s = 0.0;
};

/// A hole that is drilled or bored along an axis, with speeds and feeds of its own for in and out.
/// Programmed coordinates, mm; of a diameter axis radii.
struct Boring {
  std::string name;  ///< as the language writes it
  int axis = 2;
  double approach = 0.0, depth = 0.0, retreat = 0.0;
  double first = 0.0, next = 0.0;  ///< passes with full withdrawal, 0: one pass
  double reentry = 0.0;            ///< above the last bottom, at rapid
  ChipBreaking chips;              ///< of a hole in one pass
  double dwell_pass_s = 0.0, dwell_bottom_s = 0.0, dwell_out_s = 0.0;
  double feed = 0.0, back_feed = 0.0;  ///< as F counts; 0: the feed in force, and rapid
  double rpm = 0.0, back_rpm = 0.0;    ///< 0: the one in force
  bool only_down = false;              ///< from where the tool stands, and not back
  bool stops = false;                  ///< the spindle stands while the tool leaves
  int shift_axis = -1;                 ///< along which the tool leaves the wall ...
  double shift = 0.0;                  ///< ... by so much, signed
};

/// One hole where the other axes stand. Feed and speed are those of before again behind it.
void bore(Execution& run, const Boring& hole);

}  // namespace servogate::program
