// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "gateway/cli/bus_options.hpp"
#include "gateway/cli/latency_options.hpp"

namespace servogate::gateway {

/// `servogate bench ...`: one drive on the table.
struct BenchOptions : CanopenBusOptions {
  int node = 0;
  double cycle_us = 1000.0;
  double counts_per_rev = 0.0, rated_torque_nm = 0.0;  ///< 0: as the drive says (608Fh, 6076h)
  std::string velocity_unit = "counts";  ///< one of 60FFh and 6081h: "counts" (a second), "rpm", "0.1rpm"
  std::string travel;                    ///< FROM..TO, revolutions from where it stands
  double speed_rev_s = 0.0, torque_nm = 0.0;  ///< of the envelope
  double time_s = 60.0, following_rev = 0.25;
  std::string out;  ///< directory of the run, made anew

  std::vector<std::string> record;  ///< objects by PDO, every cycle
  std::vector<std::string> read;    ///< objects by SDO, before and after
  std::string eds;                  ///< data sheet with their names and types
  std::string limits;               ///< file of limits for the figures
  bool part = false;                ///< of a command that runs several times: its result is that command's

  // Of run, response and tune.
  std::string signal, loop = "velocity";
  double amplitude = 1.0, offset = 0.0;  ///< rev, rev/s or N m
  double duration_s = 1.0;
  std::vector<int> with;   ///< of run: further nodes that get the same signal in the same cycles
  double phase_deg = 0.0;  ///< of its sine: each further node is ahead by so much
  double move_speed = 1.0, acceleration = 10.0, jerk = 1000.0;  ///< rev/s, rev/s2, rev/s3
  double from_hz = 1.0, to_hz = 100.0;
  int period = 1024, periods = 8;
  double inertia_kg_m2 = 0.0, friction_nm = 0.0;  ///< at the least, for a torque loop; inertia 0: not given

  // Of move and jog.
  std::string mode, value;  ///< revolutions; rev/s or N m
  // Of record.
  double rate_hz = 1000.0;

  // Of identify.
  double slowest_rev_s = 0.16, excitation_nm = 0.1;
  bool no_lost_motion = false;

  // Of tune.
  std::string gains;               ///< file that says where the drive has them
  double phase_margin_deg = 50.0;  ///< to be kept
  double inner_delay_ms = 0.5;     ///< in the drive, from speed to torque
  double step_rev_s = 1.0;         ///< of the step that shows the change
  double relay_nm = 0.0;           ///< torque of a relay that takes the place of the multisine; 0: none
  bool apply = false;
};

/// `servogate bench compare`: runs beside one another.
struct BenchCompareOptions {
  std::vector<std::string> runs;  ///< their directories
  std::string out;                ///< page; empty: none
  bool json = false;
};

/// `servogate bench positioning` and `bench circle`: figures of ISO 230.
struct BenchIsoOptions {
  std::vector<std::string> files;  ///< CSV
  std::string columns = "x,y";     ///< of circle
  double radius = 0.0;             ///< of circle, nominal
  std::string out;                 ///< page; empty: none
  bool json = false;
};

struct BenchCommands {
  BenchOptions run, identify, move, jog, record, response, tune;
  BenchCompareOptions compare;
  BenchIsoOptions positioning, circle;
  LatencyOptions latency;  ///< `servogate latency`, a command of its own
};

}  // namespace servogate::gateway
