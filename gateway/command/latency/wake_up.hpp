// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <vector>

#include "firmware_if/image/time.hpp"
#include "kernel/cycle/boundary/realtime.hpp"
#include "report/statistics.hpp"

namespace servogate::gateway::command {

/// What is measured, and how.
struct WakeUpPlan {
  image::Nanoseconds cycle_ns = image::kMillisecond;
  double seconds = 10.0;
  cycle::RealtimeSettings realtime;
  bool load = false;  ///< a busy thread of usual priority for every processor
};
struct WakeUp {
  report::Histogram late;   ///< ns behind the absolute time of each cycle
  std::int64_t missed = 0;  ///< cycles that began when the next one was due already
  std::vector<cycle::RealtimeRefusal> refusals;
};

/// Sleeps to absolute times on a thread as the control has it, and notes how late it wakes. `each`: work of a
/// cycle on that thread, given its absolute time; false ends it. `ended` is asked meanwhile by the calling
/// thread. Not real-time safe.
WakeUp measure_wake_up(const WakeUpPlan& plan, const std::function<bool()>& ended,
                       const std::function<bool(image::Nanoseconds due)>& each = {});

}  // namespace servogate::gateway::command
