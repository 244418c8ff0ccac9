// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {

class Execution;

/// A thread that is tapped by the turns of the spindle, in one pass or in steps. Programmed coordinates, mm;
/// of a diameter axis radii.
struct Tapping {
  std::string name;  ///< as the language writes it
  int axis = 2;
  double approach = 0.0, depth = 0.0;
  double lead = 0.0;                        ///< along the axis, above 0
  SpindleMode in = SpindleMode::cw;         ///< how the spindle turns on the way in
  double step = 0.0;                        ///< of one pass, 0: all at once
  double back = 0.0;                        ///< between two passes, where the tool does not leave the hole
  bool leaves = false;                      ///< it does
  double dwell_s = 0.0, dwell_out_s = 0.0;  ///< at the bottom, and back at `approach`
  double back_share = 1.0;                  ///< of the speed on the last way out
};

/// One thread where the other axes stand; the spindle turns `in` again behind it.
void tap_hole(Execution& run, const Tapping& thread);

}  // namespace servogate::program
