// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/time.hpp"

namespace servogate::cycle {

/// Time that its owner sets: tests, `--virtual`, replay. Starts at 0.
class VirtualClock final : public image::Clock {
 public:
  image::Nanoseconds now_ns() const noexcept override { return now_; }
  /// Moves time on; never backwards. real-time safe.
  void set(image::Nanoseconds t) noexcept {
    if (t > now_) now_ = t;
  }

 private:
  image::Nanoseconds now_ = 0;
};

/// CLOCK_MONOTONIC, counted from the construction of the clock. The one place outside `drivers/` that asks
/// the system for the time.
class MonotonicClock final : public image::Clock {
 public:
  MonotonicClock() noexcept;
  /// real-time safe (vDSO, no system call on the usual clock sources).
  image::Nanoseconds now_ns() const noexcept override;
  /// Sleeps until an absolute time of this clock (clock_nanosleep, TIMER_ABSTIME). The cycle's only wait.
  void sleep_until(image::Nanoseconds t) const noexcept;

 private:
  image::Nanoseconds start_ = 0;
};

}  // namespace servogate::cycle
