// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "firmware_if/image/time.hpp"

namespace servogate::gsusb {

/// Puts time stamps of an adapter (32 bits of microseconds, wrapping every 71 minutes) on the computer's
/// clock. A frame cannot arrive before it was stamped, so the shortest way that a stamp ever took is the
/// difference of the clocks; it is forgotten by 200 ppm, more than two crystals differ. real-time safe.
class AdapterClock {
 public:
  /// A stamp, and the computer's time at which it arrived: the computer's time of the stamp, never after
  /// `arrival` nor before the one returned last.
  image::Nanoseconds to_host(std::uint32_t stamp_us, image::Nanoseconds arrival) noexcept {
    // Frames of one moment may come in two orders; a step back is no wrap.
    adapter_ns_ += image::Nanoseconds{static_cast<std::int32_t>(stamp_us - last_us_)} * 1000;
    last_us_ = stamp_us;
    const image::Nanoseconds ahead = arrival - adapter_ns_;
    if (!started_ || ahead < ahead_)
      ahead_ = ahead;
    else
      ahead_ = std::min(ahead, ahead_ + (arrival - last_arrival_) / kForgetting);
    started_ = true;
    last_arrival_ = arrival;
    last_result_ = std::max(last_result_, std::min(adapter_ns_ + ahead_, arrival));
    return last_result_;
  }

 private:
  static constexpr image::Nanoseconds kForgetting = 5000;
  bool started_ = false;
  std::uint32_t last_us_ = 0;
  image::Nanoseconds adapter_ns_ = 0, ahead_ = 0, last_arrival_ = 0;
  image::Nanoseconds last_result_ = std::numeric_limits<image::Nanoseconds>::min();
};

}  // namespace servogate::gsusb
