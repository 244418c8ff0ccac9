// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::bench {

/// The statements of the PLC benchmark as a person would write them in C++; in a file of its own, so that the
/// compiler sees memory as the PLC's does: anybody may look between two calls.
struct Signals {
  static constexpr int kCount = 300;
  bool v[kCount];
};
/// 10 000 times `c := a AND b` over kCount variables: number n reads n and n + 1, writes n + 2.
void ten_thousand_by_hand(Signals& s) noexcept;
/// A mixed cycle: edges, a timer, arithmetic, a branch; 1000 times.
struct Mixed {
  bool button = true, last = false, edge = false, lamp = false;
  std::int16_t count = 0, limit = 100;
  double level = 0.0, gain = 0.25;
  std::int64_t started = 0, elapsed = 0;
};
void mixed_by_hand(Mixed& m, std::int64_t now_ns) noexcept;

}  // namespace servogate::bench
