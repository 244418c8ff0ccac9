// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "bench/drive/measurement/guard.hpp"
#include "bench/drive/response/frequency_response.hpp"

namespace servogate::bench {

/// A relay in place of the velocity loop: the torque swings between two values, by the side on which the
/// speed is, so that the loop oscillates where the whole of it turns the phase by half a turn. One frequency
/// of the plant is measured in a second, with no knowledge of it. Source: Astrom and Hagglund, Automatica 20
/// (1984), 645.
struct RelayPlan {
  double speed_rad_s = 10.0;  ///< about which it swings, so that friction does not change its sign
  double torque_nm = 0.1;     ///< by which it swings to either side of what friction takes
  double hold_s = 0.3;        ///< at that speed before, to see what friction takes and how rough the speed is
  double most_s = 3.0;        ///< of swinging
  int periods = 40;           ///< that are looked at, after a quarter as many to settle
};

struct RelayResponse {
  double hz = 0.0;             ///< of the oscillation
  double inertia_kg_m2 = 0.0;  ///< as it acts at that frequency
  double dead_time_s =
      0.0;  ///< from a speed to the torque that follows from it, the way over the bus included
  double swing_rad_s = 0.0;  ///< amplitude of the speed
};

/// How the motor turns for it at the most, as speeds for Guard::accepts().
std::vector<double> relay_course(const RelayPlan& plan, double period_s);
/// On an enabled drive. nullopt: the guard has tripped, or the loop does not oscillate evenly.
std::optional<RelayResponse> take_relay(Guard& guard, const RelayPlan& plan);

/// Speed by torque of that inertia alone: good near the frequency of the oscillation and below, where nothing
/// resonates.
FrequencyResponse relay_model(const RelayResponse& response, double from_hz, double to_hz);

}  // namespace servogate::bench
