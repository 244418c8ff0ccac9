// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "bench/drive/response/frequency_response.hpp"

namespace servogate::bench {

/// A load behind a spring, as the motor feels it.
struct Coupling {
  double motor_inertia_kg_m2 = 0.0, load_inertia_kg_m2 = 0.0;
  double stiffness_nm_rad = 0.0, damping_nm_s = 0.0;
  double antiresonance_hz = 0.0;  ///< sqrt(K / J2) / 2 pi: the load swings, the motor stands
  double resonance_hz = 0.0;      ///< sqrt(K (1 / J1 + 1 / J2)) / 2 pi
};

struct Masses {
  double inertia_kg_m2 = 0.0;        ///< of everything
  double viscous_nm_s = 0.0;         ///< as the response shows it
  std::optional<Coupling> coupling;  ///< nullopt: one rigid mass explains the response
  double delay_s = 0.0;              ///< of the speed behind the torque, a share of a cycle by its sampling
  double misfit = 0.0;  ///< root mean square of ln(measured / model): 0.1 is ten per cent or six degrees
};

/// From a response of speed (rad/s) to torque (N m) within its valid range, by least squares on the
/// logarithm. nullopt: fewer than six lines. Not real-time safe.
std::optional<Masses> fit_masses(const FrequencyResponse& speed_by_torque);

/// The model's own response at a frequency.
Complex response_of(const Masses& masses, double hz) noexcept;

/// Delay of an output behind its input by the slope of the phase, s; nullopt: fewer than two lines.
std::optional<double> delay_of(const FrequencyResponse& response);

}  // namespace servogate::bench
