// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <thread>

#include "firmware_if/image/time.hpp"
#include "plc/engine/scan_watch.hpp"

namespace servogate::gateway {

/// Ends a scan of the PLC that does not come back, from a thread of its own. It sleeps between its looks and
/// counts them: a process that was suspended, or a computer that slept, costs a scan one look and not its
/// life.
class ScanWatchdog {
 public:
  /// `priority`: of its thread, SCHED_FIFO where the system grants it; above the cycle's, whose processor it
  /// may have to share. A scan is ended once it has been under way for `limit_ns` of looks.
  ScanWatchdog(plc::ScanWatch& watch, image::Nanoseconds limit_ns, int priority);
  ~ScanWatchdog();
  ScanWatchdog(const ScanWatchdog&) = delete;
  ScanWatchdog& operator=(const ScanWatchdog&) = delete;

 private:
  void run(image::Nanoseconds limit_ns, int priority);

  plc::ScanWatch& watch_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace servogate::gateway
