// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>

#include "bench/drive/response/frequency_response.hpp"

/// Gains by a measured response. Pure functions; not real-time safe.
namespace servogate::bench {

/// Of a velocity loop with PI, G (1 + R / s), a notch in its torque, and a position loop with P behind it.
struct LoopGains {
  double velocity_gain = 0.0;      ///< G, N m s/rad; above 0
  double velocity_integral = 0.0;  ///< R, 1/s
  double position_gain = 0.0;      ///< 1/s
  double notch_hz = 0.0;           ///< 0: there is no notch
  double notch_depth = 1.0;        ///< how much the notch leaves at its centre, Notch::damping
};

/// What a tuned loop has to keep.
struct TuningWish {
  double phase_margin_deg = 50.0;
  double gain_margin_db = 8.0;
  /// Greatest |1 / (1 + L)|: how near L comes to -1 anywhere, a resonance behind the crossover included.
  double sensitivity_db = 6.0;
  double position_peak_db = 0.5;   ///< of the closed position loop: it does not overshoot
  double most_times = 10.0;        ///< the gain is changed by at most so much, in either direction
  double most_crossover_hz = 0.0;  ///< of the velocity loop; 0: as far as was measured
};

/// A notch in the torque: (s^2 + 2 d w s + w^2) / (s^2 + 2 w s + w^2), w = 2 pi hz.
struct Notch {
  double hz = 0.0;
  double damping = 0.0;  ///< d, below 1: how much is left at its centre
};
Complex notch_at(const Notch& notch, double hz) noexcept;

/// Gains and what they are expected to do.
struct Tuning {
  LoopGains gains;
  Margins velocity, position;          ///< of the open loops
  double velocity_bandwidth_hz = 0.0;  ///< of the closed one, 0: beyond the range
  double sensitivity_db = 0.0;
  FrequencyResponse closed;  ///< velocity loop, by set-point
};

/// The open velocity loop of these gains on a plant, speed by torque, with what the drive needs from a
/// measured speed to the torque that follows from it.
FrequencyResponse velocity_loop(const FrequencyResponse& plant, const LoopGains& gains, double inner_delay_s);
/// The open velocity loop with other gains.
FrequencyResponse with_gains(const FrequencyResponse& open_loop, const LoopGains& present,
                             const LoopGains& wanted);
/// What is to be expected of gains; nullopt: |L| never falls through 1 within the range, so that nothing can
/// be said of them.
std::optional<Tuning> expect(const FrequencyResponse& open_loop, const LoopGains& present,
                             const LoopGains& wanted);
/// The stiffest gains that keep the wish: the greatest velocity gain, with it the greatest integral rate, and
/// on that loop the greatest position gain, 0: not even 1/s goes without overshoot; with this notch, or
/// nullptr with the present one. nullopt: none within `most_times` keeps it.
std::optional<Tuning> tune(const FrequencyResponse& open_loop, const LoopGains& present,
                           const TuningWish& wish, const Notch* notch = nullptr);
/// A notch for the strongest resonance of the open loop beyond its crossover; nullopt: none stands out.
std::optional<Notch> notch_for(const FrequencyResponse& open_loop);

/// Answer to a unit step of a loop that answers its set-point by `closed`, which is taken for 1 below its
/// range and for nothing beyond it.
std::vector<double> step_of(const FrequencyResponse& closed, double period_s, double seconds);

}  // namespace servogate::bench
