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

/// The harmonic for which runs of at least a whole turn each say most, in either direction, and how large it
/// roughly is: cogging makes the speed uneven, and what that takes of the torque is not known yet. nullopt:
/// less than a turn, or no harmonic stands out from the others (in one run: five times). Not real-time safe.
std::optional<Cogging> find_cogging(std::span<const EvenRun> runs, int most_periods = 300);

/// Size and phase of a harmonic whose number is known: what its torque has beside what the motion of motor
/// and load takes at its frequency, over the angle that was. Of runs in one direction each, of any length,
/// slow against the antiresonance or faster than the resonance: near both a little error of the masses is a
/// large one of the torque. From runs at several speeds in both directions also comes by how much the torque
/// is measured after the angle (-1 to 3 ms), and by how much the inertia is off. nullopt: they hold less than
/// three periods. Not real-time safe.
std::optional<Cogging> size_cogging(std::span<const EvenRun> runs, const Masses& masses,
                                    const FrictionCurve& friction, int periods);

}  // namespace servogate::bench
