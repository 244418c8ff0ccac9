// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "drivers/notice.hpp"
#include "gateway/control/compose/control.hpp"
#include "gateway/control/run/scan_watchdog.hpp"
#include "kernel/cycle/boundary/realtime.hpp"

namespace servogate::gateway {

/// Runs a Control in real time: one thread for the cycle at absolute times, one that reads ahead, and with a
/// PLC one that ends a scan which does not come back. The owner watches by Cycle::read() and speaks by
/// Cycle::post().
class RealtimeLoop {
 public:
  /// Called after every cycle on the real-time thread; must be real-time safe. `late_ns`: how late the thread
  /// woke up.
  using AfterCycle = std::function<void(Control&, image::Nanoseconds late_ns)>;

  RealtimeLoop(Control& control, cycle::RealtimeSettings settings, AfterCycle after);
  ~RealtimeLoop();

  /// Starts both threads and waits until the real-time set-up is known. False: something needed was refused
  /// and best effort was not asked for; nothing runs.
  bool start();
  /// Ends both threads after the cycle under way.
  void stop();
  /// After start(): what the system refused, and the command that grants it: as what kept the loop from
  /// starting, or as what it goes on without.
  void add_refusals(bool started, std::vector<drivers::Notice>& refusals) const;
  std::int64_t overruns() const noexcept { return overruns_.load(std::memory_order_relaxed); }

 private:
  void cycle_thread();

  Control& control_;
  cycle::RealtimeSettings settings_;
  AfterCycle after_;
  cycle::MonotonicClock clock_;
  std::vector<cycle::RealtimeRefusal> refusals_;
  std::atomic<bool> stop_{false};
  std::atomic<int> ready_{0};
  std::atomic<std::int64_t> overruns_{0};
  std::thread cycle_thread_, reader_thread_;
  std::unique_ptr<ScanWatchdog> watchdog_;
};

}  // namespace servogate::gateway
