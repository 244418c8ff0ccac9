// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

namespace servogate::bench {

/// Where the motor stood when it pressed against a load at rest.
struct Press {
  double torque_nm = 0.0;  ///< what reaches the coupling, with its direction
  double angle_rad = 0.0;
};

struct LostMotion {
  double backlash_rad = 0.0;      ///< at no torque; 0: none beyond `deviation_rad`
  double stiffness_nm_rad = 0.0;  ///< of the closed coupling
  double deviation_rad = 0.0;     ///< standard deviation of the backlash by the scatter of the presses
};

/// From presses in both directions with at least two torques each: angle = middle + sign * backlash / 2 +
/// torque / stiffness, by least squares. nullopt: too few, or the angle does not grow with the torque. Not
/// real-time safe.
std::optional<LostMotion> fit_lost_motion(std::span<const Press> presses);

}  // namespace servogate::bench
