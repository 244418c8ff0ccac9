// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway {

/// `servogate latency`: how exactly this computer keeps a cycle.
struct LatencyOptions : CanopenBusOptions {  ///< bus empty: the computer alone
  std::string
      machine;  ///< file of a machine on simulated buses whose cycle is measured by phases; empty: none
  int node = 0;
  double cycle_us = 1000.0, seconds = 10.0;
  int priority = 80, cpu = -1;
  bool load = false;  ///< keeps every processor busy meanwhile
};

}  // namespace servogate::gateway
