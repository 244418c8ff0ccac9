// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway {

/// `servogate bench run` and `bench identify`: one drive on the table.
struct BenchOptions : CanopenBusOptions {
  int node = 0;
  double cycle_us = 1000.0;
  double counts_per_rev = 0.0, rated_torque_nm = 0.0;  ///< 0: as the drive says (608Fh, 6076h)
  std::string travel;                                  ///< FROM..TO, revolutions from where it stands
  double speed_rev_s = 0.0, torque_nm = 0.0;           ///< of the envelope
  double time_s = 60.0, following_rev = 0.25;
  std::string out;  ///< directory of the run, made anew

  // Of run.
  std::string signal, loop;
  double amplitude = 1.0, offset = 0.0;  ///< rev, rev/s or N m
  double duration_s = 1.0;
  double move_speed = 1.0, acceleration = 10.0, jerk = 1000.0;  ///< rev/s, rev/s2, rev/s3
  double from_hz = 1.0, to_hz = 100.0;
  int period = 1024, periods = 8;

  // Of identify.
  double slowest_rev_s = 0.16, excitation_nm = 0.1;
  bool no_lost_motion = false;
};

}  // namespace servogate::gateway
