// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/wake_up.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <thread>

#include "drivers/clock.hpp"
#include "gateway/command/latency/busy_processors.hpp"

namespace servogate::gateway::command {
WakeUp measure_wake_up(const WakeUpPlan& plan, const std::function<bool()>& ended,
                       const std::function<bool(image::Nanoseconds)>& each) {
  const BusyProcessors busy(plan.load);
  WakeUp out;
  std::atomic<bool> stop{false}, done{false};
  std::thread cycle([&] {
    const cycle::RealtimeThread realtime(plan.realtime);
    out.refusals = realtime.refusals();
    const auto cycles = static_cast<std::int64_t>(plan.seconds * 1e9 / static_cast<double>(plan.cycle_ns));
    image::Nanoseconds due = drivers::clock_ns(CLOCK_MONOTONIC) + 10 * plan.cycle_ns;
    for (std::int64_t n = 0; n < cycles && !stop.load(std::memory_order_relaxed); ++n, due += plan.cycle_ns) {
      const timespec until{due / image::kSecond, due % image::kSecond};
      while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
      }
      const image::Nanoseconds late = drivers::clock_ns(CLOCK_MONOTONIC) - due;
      out.late.add(late);
      if (late >= plan.cycle_ns) ++out.missed;
      if (each && !each(due)) break;
    }
    done = true;
  });
  while (!done) {
    if (ended()) stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  cycle.join();
  return out;
}

}  // namespace servogate::gateway::command
