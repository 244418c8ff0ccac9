// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/coupling/angle_track.hpp"

#include <algorithm>

namespace servogate::axis {

void AngleTrack::put(double turns, image::Nanoseconds t_ns) noexcept {
  head_ = (head_ + 1) % kKept;
  places_[static_cast<std::size_t>(head_)] = {turns, t_ns};
  count_ = std::min(count_ + 1, kKept);
}

double AngleTrack::at(image::Nanoseconds t_ns) const noexcept {
  if (count_ == 1) return newest();
  int n = 0;
  while (n + 2 < count_ && ago(n + 1).t_ns > t_ns) ++n;
  const Place &later = ago(n), &before = ago(n + 1);
  if (later.t_ns == before.t_ns) return later.turns;
  const double share =
      static_cast<double>(t_ns - before.t_ns) / static_cast<double>(later.t_ns - before.t_ns);
  return before.turns + share * (later.turns - before.turns);
}

}  // namespace servogate::axis
