// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ctime>

#include "firmware_if/image/time.hpp"

namespace servogate::drivers {

/// A clock of the system in nanoseconds: CLOCK_MONOTONIC for time stamps, CLOCK_REALTIME for what people and
/// other programs read. real-time safe (vDSO).
inline image::Nanoseconds clock_ns(clockid_t id) noexcept {
  timespec t{};
  clock_gettime(id, &t);
  return t.tv_sec * image::kSecond + t.tv_nsec;
}

/// What CLOCK_REALTIME is ahead of CLOCK_MONOTONIC just now. real-time safe.
inline image::Nanoseconds realtime_ahead() noexcept {
  return clock_ns(CLOCK_REALTIME) - clock_ns(CLOCK_MONOTONIC);
}

}  // namespace servogate::drivers
