// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"
#include "tests/path/rig/frechet.hpp"
#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {

/// What happens to a program while it runs, at cycles drawn from `seed`.
struct Scenario {
  static constexpr double kTurns = 10.0;  ///< revolutions/s that feeds per revolution are planned for
  std::uint64_t seed = 1;
  bool overrides = false;  ///< the override jumps, 0 included
  bool holds = false;      ///< hold and resume
  bool starving = false;   ///< planning is pulled at random cycles only, a few elements at a time
  bool late = false;       ///< the follower sees only part of what is published
  int disturbed = 3000;    ///< cycles after which all is left alone, at override 1
  bool spindle = false;    ///< it goes from speed to speed, up to 1.2 times kTurns, and rests at times
};

/// What crosses the real-time line in one cycle, as a record keeps it.
struct Record {
  std::uint64_t visible = 0;
  double override_ratio = 1.0;
  double turns = -1.0;  ///< of the spindle, revolutions/s; below 0: none
  bool hold = false, release = false;
};

struct Trip {
  std::vector<Sample> samples;  ///< one a cycle, the start first
  std::vector<Record> record;   ///< one a cycle
  bool ended = false;           ///< came to the end within the cycles allowed
};

/// Runs a program to its end.
Trip run(const RandomProgram& program, const Scenario& scenario, int most_cycles = 400000);

/// Runs it again from a record alone, with everything planned beforehand.
Trip replay(const RandomProgram& program, const std::vector<Record>& record);

/// The worst of each limit that the set-points reach, judged by finite differences over the cycle, as a ratio
/// of the limit; velocity and acceleration over all axes too.
struct Worst {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
  double most() const;
};
Worst worst(const Trip& run, const Config& config);

Polyline points(const Trip& run);

/// Empty when the run kept every law: it ended, in the end point to 1 nm, inside all limits by 0.1 %, and
/// within the tolerance of the programmed path. Otherwise what is wrong.
std::string verdict(const Trip& run, const RandomProgram& program, Worst* reached = nullptr);

}  // namespace servogate::path::test
