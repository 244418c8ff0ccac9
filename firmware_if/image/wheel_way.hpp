// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

namespace servogate::image {

/// The way that an axis is asked for by counts of a handwheel: as many whole counts as keep what is left of
/// its jog within `room`; the others are lost. `way` = counts * `step`; `left`: what is left now, above 0 in
/// the direction of `way`. An axis that rests follows one count at least, however long its step. Ways that
/// are no number come back as they are. real-time safe.
inline double wheel_way(double way, double step, double room, double left) noexcept {
  if (!std::isfinite(way) || way == 0.0 || std::abs(way) <= room - left) return way;
  const double length = std::abs(step), least = left <= 0.0 ? 1.0 : 0.0;
  return std::copysign(length * std::max(std::floor((room - left) / length), least), way);
}

}  // namespace servogate::image
