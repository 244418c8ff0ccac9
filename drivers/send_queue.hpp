// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <utility>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::drivers {

/// Frames that an interface did not take yet, the one that would win the arbitration first, equal identifiers
/// in the order of push(). real-time safe.
class SendQueue {
 public:
  static constexpr std::size_t kCapacity = 128;

  /// False: full, nothing was queued.
  bool push(const image::CanFrame& frame) noexcept {
    if (count_ == kCapacity) return false;
    const std::uint32_t key = image::arbitration_key(frame);
    std::size_t at = count_++;
    for (; at > 0 && image::arbitration_key(frames_[at - 1]) <= key; --at) frames_[at] = frames_[at - 1];
    frames_[at] = frame;
    return true;
  }
  bool empty() const noexcept { return count_ == 0; }
  std::size_t size() const noexcept { return count_; }
  const image::CanFrame& first() const noexcept { return frames_[count_ - 1]; }
  void pop() noexcept { --count_; }
  /// Throws everything away; how much it was.
  std::size_t clear() noexcept { return std::exchange(count_, 0); }

 private:
  std::array<image::CanFrame, kCapacity> frames_{};  ///< the first to go is the last
  std::size_t count_ = 0;
};

}  // namespace servogate::drivers
