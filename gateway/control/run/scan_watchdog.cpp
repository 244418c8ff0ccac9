// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/scan_watchdog.hpp"

#include <algorithm>

#include "kernel/cycle/boundary/clocks.hpp"
#include "kernel/cycle/boundary/realtime.hpp"

namespace servogate::gateway {

namespace {
constexpr int kLooks = 25;  ///< within the limit
constexpr int kHighestPriority = 99;
}  // namespace

ScanWatchdog::ScanWatchdog(plc::ScanWatch& watch, image::Nanoseconds limit_ns, int priority)
    : watch_(watch), thread_([this, limit_ns, priority] { run(limit_ns, priority); }) {}

ScanWatchdog::~ScanWatchdog() {
  stop_.store(true);
  thread_.join();
}

void ScanWatchdog::run(image::Nanoseconds limit_ns, int priority) {
  // What is refused was said of the cycle's own thread.
  const cycle::RealtimeThread thread({std::min(priority, kHighestPriority), -1, true});
  const cycle::MonotonicClock clock;
  std::uint64_t seen = 0;
  int looks = 0;
  while (!stop_.load(std::memory_order_relaxed)) {
    const std::uint64_t scan = watch_.under_way();
    looks = scan == seen ? looks + 1 : 0;
    seen = scan;
    if (scan != 0 && looks >= kLooks) watch_.end(scan);
    clock.sleep_until(clock.now_ns() + limit_ns / kLooks);
  }
}

}  // namespace servogate::gateway
