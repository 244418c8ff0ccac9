// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

#include "bench/drive/identification/masses.hpp"

namespace servogate::bench {

/// A torque that repeats with the angle of the motor: amplitude * sin(periods * angle + phase) holds it back.
struct Cogging {
  double amplitude_nm = 0.0;
  int periods = 0;  ///< in a turn
  double phase_rad = 0.0;
  double at(double angle_rad) const noexcept;
};

/// What a run at an even speed showed: angle of the motor from its encoder's zero, and its torque.
struct EvenRun {
  std::span<const double> angle_rad, torque_nm;
  double period_s = 0.001;
  double friction_slope = 0.0;  ///< of the friction curve at this speed, N m s/rad
};

/// The strongest harmonic of runs of at least a whole turn each, in either direction. Cogging makes the speed
/// uneven; what that takes of the torque follows from `masses`, nullptr: nothing is known of it yet. Drives
/// measure torque and angle a share of a cycle apart: of several runs that skew is found, too. nullopt:
/// less than a turn, or no harmonic stands out from the others five times. Not real-time safe.
std::optional<Cogging> fit_cogging(std::span<const EvenRun> runs, const Masses* masses,
                                   int most_periods = 300);

}  // namespace servogate::bench
