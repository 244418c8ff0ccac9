// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::program {

class Execution;

/// A turning cycle in the plane of two axes: it cuts `along` one and sets its depth `across` the other.
/// Programmed coordinates, mm; of a diameter axis radii. It begins where the axes stand.
struct Turning {
  std::string name;  ///< as the language writes it
  int along = 2, across = 0;
  double along_end = 0.0, across_end = 0.0;
  double bevel_along = 0.0, bevel_across = 0.0;  ///< of the end of the cut, no sign
  bool sets_at_rapid = true;                     ///< the way to the depth
  double step = 0.0;                             ///< of one pass, no sign
  double clearance = 0.0;                        ///< by which the tool leaves, and re-enters above, a cut
};

/// One pass with its bevel and the facing behind it, and back to where it began.
void turn_once(Execution& run, const Turning& cycle);
/// Passes of `step` across, the last one with the bevel and the facing; back to where it began.
void turn_rough(Execution& run, const Turning& cycle);
/// One groove along `along` in steps with full withdrawal; back to where it began.
void turn_pecks(Execution& run, const Turning& cycle);
/// Grooves along `along`, each `step` further across, the last one at `across_end`, above which it ends.
void turn_grooves(Execution& run, const Turning& cycle);

}  // namespace servogate::program
