// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "firmware_if/image/time.hpp"

namespace servogate::gpio {

/// From CLOCK_MONOTONIC to machine time. A cycle is woken late, never early: the least that the clock was
/// ahead of the machine in the last 32 to 64 cycles is what it is ahead. real-time safe.
class CycleTimes {
 public:
  /// Once at the begin of each cycle: the clock shows `clock_ns`, the cycle opened at `t_ns`.
  void open(image::Nanoseconds clock_ns, image::Nanoseconds t_ns) noexcept {
    const image::Nanoseconds ahead = clock_ns - t_ns;
    if (++cycles_ > kWindow) {
      before_ = now_;
      now_ = ahead;
      cycles_ = 1;
      known_ = true;
    } else {
      now_ = cycles_ == 1 ? ahead : std::min(now_, ahead);
    }
  }
  /// After the first open().
  image::Nanoseconds machine(image::Nanoseconds clock_ns) const noexcept {
    return clock_ns - (known_ ? std::min(now_, before_) : now_);
  }

 private:
  static constexpr int kWindow = 32;
  image::Nanoseconds now_ = 0, before_ = 0;
  int cycles_ = 0;
  bool known_ = false;
};

}  // namespace servogate::gpio
