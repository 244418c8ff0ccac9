// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>

#include "bench/machine.hpp"

namespace servogate::bench {

/// Cost of the cycle of one machine, and how fast its time passes.
struct CycleCost {
  double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0;
  double virtual_speed = 0.0;  ///< simulated seconds per second, simulated devices included
  double seconds = 0.0;        ///< simulated, while the program ran
  bool finished = false;       ///< the program came to its end
};

/// Switches the machine on, homes it, runs its loaded program to the end; measures from its start to its end.
CycleCost measure(Machine& machine);
/// The median of each figure over `runs` fresh machines.
CycleCost median_of(int runs, const std::function<std::unique_ptr<Machine>()>& fresh);

}  // namespace servogate::bench
