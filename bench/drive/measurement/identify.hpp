// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "bench/drive/identification/cogging.hpp"
#include "bench/drive/identification/friction.hpp"
#include "bench/drive/identification/lost_motion.hpp"
#include "bench/drive/identification/masses.hpp"
#include "bench/drive/measurement/guard.hpp"

namespace servogate::bench {

/// How motor and load are identified. The envelope bounds all of it.
struct IdentifyPlan {
  double slow_rad_s = 1.0, fast_rad_s = 100.0;  ///< of the friction curve
  int speeds = 9;                               ///< of it, in equal ratios
  double hold_s = 0.4;  ///< at each speed at least; the slowest that makes a turn in `turn_s` makes one
  double turn_s = 1.3;
  double bias_rad_s = 50.0;  ///< at which the frequency response is taken: the shaft never turns back
  double torque_nm = 0.1;  ///< root mean square of its excitation, made less where the load would come loose
  double from_hz = 2.0, to_hz = 180.0;
  std::size_t block = 512;
  int blocks = 18;          ///< averaged
  bool lost_motion = true;  ///< presses against the load at rest
};

struct Identified {
  FrictionCurve friction;
  std::vector<FrictionPoint> friction_points;
  std::optional<Cogging> cogging;
  Masses masses;
  FrequencyResponse response;             ///< of speed to torque
  std::optional<LostMotion> lost_motion;  ///< nullopt: the shaft yields to no press, it is rigid
  std::optional<double> command_delay_s;  ///< from a set-point of torque to the measured torque
  double excitation_nm = 0.0;             ///< root mean square, as it was
};

/// How far the motor turns for it, rad, either way from where it stands.
struct Reach {
  double from_rad = 0.0, to_rad = 0.0;
};
Reach reach_of(const IdentifyPlan& plan, double period_s);

/// The whole measurement on an enabled drive. nullopt: the guard has tripped, or `why` says what could not be
/// found ("friction", "masses").
std::optional<Identified> identify(Guard& guard, const IdentifyPlan& plan, std::string& why);

}  // namespace servogate::bench
