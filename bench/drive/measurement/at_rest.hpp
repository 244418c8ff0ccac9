// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "bench/drive/identification/cogging.hpp"
#include "bench/drive/identification/friction.hpp"
#include "bench/drive/identification/lost_motion.hpp"
#include "bench/drive/identification/masses.hpp"
#include "bench/drive/measurement/guard.hpp"

namespace servogate::bench {

/// What is known of motor and load before they are looked at at rest.
struct KnownPlant {
  const FrictionCurve& friction;
  const std::optional<Cogging>& cogging;
  const Masses& masses;
};

/// What a load at rest shows.
struct AtRest {
  std::vector<Press> presses;
  /// Torque that moved it, in both directions by turns, at FrictionPoint::kAtRest. Fewer than asked for: it
  /// did not move by as much as friction has.
  std::vector<FrictionPoint> breakaways;
};

/// Presses motor against load in both directions, then harder until the load moves, at several places: what
/// the cogging is off cancels. Drive enabled and moving as it may. False: the guard has tripped.
bool look_at_rest(Guard& guard, const KnownPlant& plant, AtRest& out);

}  // namespace servogate::bench
