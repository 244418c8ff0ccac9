// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "bench/drive/measurement/guard.hpp"
#include "bench/drive/response/frequency_response.hpp"

namespace servogate::bench {

/// What a drive makes of a set-point until the next one.
enum class Hold : std::uint8_t {
  held,          ///< it stays
  interpolated,  ///< it is reached evenly at the next one (csp with 60C2h)
};
/// The response of that between two cycles, which belongs to the bus and not to the loop.
Complex hold_response(Hold hold, double hz, double period_s) noexcept;

/// How the frequency response of a loop of the drive is taken: a multisine on its set-point.
struct LoopResponsePlan {
  Loop loop = Loop::velocity;
  double excitation = 1.0;  ///< root mean square, in the unit of the loop
  double offset = 0.0;      ///< added to it; the guard ramps to it within `ramp_s`
  double ramp_s = 0.25;
  double from_hz = 2.0, to_hz = 300.0;  ///< at most 0.45 of the sample rate
  std::size_t block = 1024;             ///< samples of a period
  int blocks = 12;                      ///< averaged, after one for the loop to settle
  /// Cycles between a set-point and the answer that was measured when it began to act: two on a bus with
  /// SYNC. They belong to the bus and are taken out of the response.
  int bus_cycles = 2;
  Hold hold = Hold::held;  ///< taken out, too
};

/// What came of it. Margins and bandwidth within its valid range alone.
struct LoopResponse {
  /// Actual by set-point, and closed / (1 - closed). What the drive itself waits or leads, a quarter of a
  /// millisecond often, is in both: at 100 Hz that is ten per cent of the open loop.
  FrequencyResponse closed, open;
  /// Speed by torque, both measured at one SYNC, so that no time of bus or drive is in it.
  FrequencyResponse plant;
  Margins margins;
  std::optional<double> bandwidth_hz;  ///< of the closed loop, -3 dB
  double peak_db = 0.0;                ///< greatest of the closed loop
  std::vector<Extreme> extremes;       ///< of the open loop
};

/// The whole excitation as set-points, for Guard::accepts(). Empty: it cannot be sampled.
std::vector<double> loop_excitation(const LoopResponsePlan& plan, double period_s);
/// On an enabled drive, which is off afterwards. nullopt: the guard has tripped, or no line of the response
/// is coherent.
std::optional<LoopResponse> take_loop_response(Guard& guard, const LoopResponsePlan& plan);

}  // namespace servogate::bench
