// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::image {

/// Time is a cycle number and integer nanoseconds, never a running double (docs/architecture.md, rule 1).
using Nanoseconds = std::int64_t;

inline constexpr Nanoseconds kMicrosecond = 1'000;
inline constexpr Nanoseconds kMillisecond = 1'000'000;
inline constexpr Nanoseconds kSecond = 1'000'000'000;

/// One instant of the control: cycle `number` opens at `t_ns = number * period_ns` after the start.
struct CycleTime {
  std::int64_t number = 0;
  Nanoseconds t_ns = 0;
  Nanoseconds period_ns = kMillisecond;

  /// Seconds since cycle 0. real-time safe.
  double seconds() const noexcept { return static_cast<double>(t_ns) * 1e-9; }
  /// Length of a cycle in seconds. real-time safe.
  double period_s() const noexcept { return static_cast<double>(period_ns) * 1e-9; }
};

/// The only source of time outside `drivers/`. Implementations: virtual (advanced by its owner) and
/// monotonic.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Nanoseconds since an arbitrary start, never decreasing. real-time safe.
  virtual Nanoseconds now_ns() const noexcept = 0;
};

}  // namespace servogate::image
