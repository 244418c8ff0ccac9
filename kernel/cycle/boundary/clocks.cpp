// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/boundary/clocks.hpp"

#include <cerrno>
#include <ctime>

namespace servogate::cycle {

namespace {
image::Nanoseconds monotonic() noexcept {
  timespec ts{};
  clock_gettime(CLOCK_MONOTONIC, &ts);
  return static_cast<image::Nanoseconds>(ts.tv_sec) * image::kSecond + ts.tv_nsec;
}
}  // namespace

MonotonicClock::MonotonicClock() noexcept : start_(monotonic()) {}

image::Nanoseconds MonotonicClock::now_ns() const noexcept { return monotonic() - start_; }

void MonotonicClock::sleep_until(image::Nanoseconds t) const noexcept {
  const image::Nanoseconds absolute = start_ + t;
  const timespec ts{static_cast<time_t>(absolute / image::kSecond),
                    static_cast<long>(absolute % image::kSecond)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &ts, nullptr) == EINTR) {
  }
}

}  // namespace servogate::cycle
