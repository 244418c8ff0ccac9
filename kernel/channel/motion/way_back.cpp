// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/way_back.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::channel {

namespace {
constexpr double kSame = 1e-9;  ///< mm or degrees
}  // namespace

void WayBack::leave(int axis, double from) noexcept {
  if (away() && this->axis() == axis) return;
  if (full()) return;
  legs_[count_++] = {static_cast<std::int8_t>(axis), from};
}

void WayBack::step(std::span<axis::Axis> axes) noexcept {
  while (away()) {
    axis::Axis& a = axes[static_cast<std::size_t>(axis())];
    if (a.moving()) return;
    if (std::abs(a.setpoint().x - from()) <= kSame) {
      --count_;
      moves_ = false;
      continue;
    }
    if (!returns_) return;
    // What was begun and stands beside its end was stopped.
    const double velocity = velocity_ > 0.0 ? std::min(velocity_, a.jog_speed()) : a.jog_speed();
    moves_ = !moves_ && a.move_to(from(), velocity);
    returns_ = moves_;
    return;
  }
  returns_ = false;
}

}  // namespace servogate::channel
