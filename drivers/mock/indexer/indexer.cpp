// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/indexer/indexer.hpp"

#include <algorithm>

namespace servogate::mock {

Indexer::Indexer(int positions, image::Nanoseconds step_ns, int start)
    : positions_(std::max(positions, 1)),
      step_ns_(std::max<image::Nanoseconds>(step_ns, 2)),
      turned_ns_(std::clamp(start, 0, positions_ - 1) * step_ns_) {}

void Indexer::advance_to(image::Nanoseconds t, bool motor) noexcept {
  if (t > t_ns_) {
    if (motor_) turned_ns_ = (turned_ns_ + t - t_ns_) % (positions_ * step_ns_);
    t_ns_ = t;
  }
  motor_ = motor;
}

int Indexer::position() const noexcept {
  const image::Nanoseconds phase = turned_ns_ % step_ns_;
  const int behind = static_cast<int>(turned_ns_ / step_ns_);
  if (phase == 0) return behind;
  return 2 * phase < step_ns_ ? -1 : (behind + 1) % positions_;
}

}  // namespace servogate::mock
