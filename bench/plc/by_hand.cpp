// SPDX-License-Identifier: Apache-2.0
#include "bench/plc/by_hand.hpp"

#include <utility>

namespace servogate::bench {

namespace {

// One after another as straight code, as the PLC's program is, and each really stored.
inline void statement(volatile bool* v) noexcept { v[2] = v[0] && v[1]; }
template <int... kOffsets>
void block(volatile bool* v, std::integer_sequence<int, kOffsets...>) noexcept {
  (statement(v + kOffsets), ...);
}

}  // namespace

void ten_thousand_by_hand(Signals& s) noexcept {
  volatile bool* v = s.v;
  for (int i = 0; i < 10'000 / 250; ++i) block(v, std::make_integer_sequence<int, 250>{});
}

void mixed_by_hand(Mixed& m, std::int64_t now_ns) noexcept {
  m.edge = m.button && !m.last;
  m.last = m.button;
  if (m.edge) m.started = now_ns;
  m.elapsed = now_ns - m.started;
  m.lamp = m.elapsed >= 500'000'000;
  if (m.count < m.limit)
    m.count = static_cast<std::int16_t>(m.count + 1);
  else
    m.count = 0;
  m.level = m.level + m.gain * (static_cast<double>(m.count) - m.level);
}

}  // namespace servogate::bench
