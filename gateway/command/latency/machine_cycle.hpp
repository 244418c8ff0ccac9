// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "drivers/notice.hpp"
#include "machine/load.hpp"
#include "report/statistics.hpp"

namespace servogate::gateway::command {

/// The cycle of a whole machine in real time.
struct MachineCycle {
  report::CycleTimes times;
  std::int64_t overruns = 0;
  std::vector<drivers::Notice> refusals;  ///< what the system refused
};

/// Runs a machine on simulated buses at rest for so long, as well as the system permits, and takes the times
/// of every phase of its cycle. `ended` is asked meanwhile. nullopt: it could not be composed or started,
/// which has been said. Not real-time safe.
std::optional<MachineCycle> measure_machine(const machine::LoadResult& loaded, double seconds, bool load,
                                            const std::function<bool()>& ended);

}  // namespace servogate::gateway::command
