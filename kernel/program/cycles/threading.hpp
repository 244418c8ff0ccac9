// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace servogate::program {

class Execution;

/// A thread that is turned in passes from where the tool stands. Programmed coordinates, mm; of a diameter
/// axis radii.
struct Threading {
  std::string name;  ///< as the language writes it
  int along = 2, across = 0;
  double along_end = 0.0, across_end = 0.0;  ///< end of the thread, at its root
  double taper = 0.0;                        ///< of its beginning from its end, signed
  double lead = 0.0;
  double run_out = 0.0;          ///< before the end, where the tool leaves at 45 degrees; no sign
  double start_angle_deg = 0.0;  ///< of the spindle
};

/// One pass whose end is at `across`, and back to where it began.
void thread_pass(Execution& run, const Threading& thread, double across, double shift = 0.0);

/// Depths of passes of equal chips down to `depth`: the first one, and none less than `least` below the one
/// before it. Throws where there are too many.
std::vector<double> thread_depths(const std::string& name, double depth, double first, double least);

}  // namespace servogate::program
