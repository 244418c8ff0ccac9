// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

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
};

/// The strongest harmonic of at least a whole turn, with `inertia` and `friction_slope` (N m s/rad) taken
/// into account, because cogging makes the speed uneven. nullopt: less than a turn, or none stands out from
/// the others five times. Not real-time safe.
std::optional<Cogging> fit_cogging(const EvenRun& run, double inertia_kg_m2, double friction_slope,
                                   int most_periods = 300);

}  // namespace servogate::bench
