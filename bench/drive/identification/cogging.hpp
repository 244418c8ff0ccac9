// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

#include "bench/drive/identification/friction.hpp"
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
};

/// The strongest harmonic of runs of at least a whole turn each, in either direction, and how large it
/// roughly is: cogging makes the speed uneven, and what that takes of the torque is not known yet. nullopt:
/// less than a turn, or no harmonic stands out from the others five times. Not real-time safe.
std::optional<Cogging> find_cogging(std::span<const EvenRun> runs, int most_periods = 300);

/// Size and phase of a harmonic whose number is known: what the torque has beside friction and inertia over
/// the angle that was, so that an uneven speed may be as uneven as it likes. Of runs of any length in one
/// direction each, well below the antiresonance, where the load follows. nullopt: they hold less than three
/// periods. Not real-time safe.
std::optional<Cogging> size_cogging(std::span<const EvenRun> runs, const Masses& masses,
                                    const FrictionCurve& friction, int periods);

}  // namespace servogate::bench
