// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

namespace servogate::bench {

/// Where the motor stood when it pressed against a load at rest.
struct Press {
  double torque_nm = 0.0;  ///< what reaches the coupling, with its direction
  double angle_rad = 0.0;
  int place = 0;  ///< presses of one place are against a load that has not moved between them
};

struct LostMotion {
  double backlash_rad = 0.0;      ///< at no torque; 0: none beyond four `deviation_rad`
  double stiffness_nm_rad = 0.0;  ///< of the closed coupling
  double deviation_rad = 0.0;     ///< standard deviation of the backlash by its scatter
};

/// From presses in both directions with at least two torques each, at one place or several: the twist by
/// least squares of angle over torque, the same at all of them, and what is left between the directions is
/// the backlash. Its mean over the places counts, without those where the load gave way. nullopt: too few, or
/// the angle does not grow with the torque. Not real-time safe.
std::optional<LostMotion> fit_lost_motion(std::span<const Press> presses);

}  // namespace servogate::bench
