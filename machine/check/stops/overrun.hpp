// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "machine/load.hpp"

/// The room between a limit switch and the mechanical end behind it, against the way that a stop takes. mm or
/// degrees, s.
namespace servogate::machine {

/// A jerk-limited stop from speed v to rest. Where the acceleration is not reached, the profile is two ramps
/// of jerk.
struct Stop {
  double way = 0.0;
  double time = 0.0;
};
Stop stop_from(double velocity, double acceleration, double jerk);

struct Overrun {
  double room = 0.0;      ///< from where the switch works to the mechanical end
  double unseen = 0.0;    ///< s from the switch to the first cycle of the stop
  double velocity = 0.0;  ///< greatest speed of an axis that is not homed: jogging, search for its switch
  double way = 0.0;       ///< from the switch to rest at that speed
  double safe_velocity = 0.0;  ///< greatest speed from which it ends before the mechanical end
};
/// nullopt: switch, its place or the mechanical end of that side is not in the file.
std::optional<Overrun> overrun(const LoadResult& loaded, const AxisConfig& axis, bool plus);

}  // namespace servogate::machine
