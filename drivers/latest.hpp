// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace servogate::drivers {

/// The newest value from one thread to another: neither waits, and what was not taken in time is replaced.
/// Three slots, of which each side holds one. real-time safe where copying a T is.
template <typename T>
class Latest {
 public:
  /// Of the writing thread.
  void put(const T& value) noexcept {
    slots_[back_] = value;
    back_ = static_cast<std::uint8_t>(
        middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kSlot);
  }
  /// Of the reading thread: what was put since the last take(), nullptr: nothing. Stays until the next call.
  const T* take() noexcept {
    if ((middle_.load(std::memory_order_acquire) & kFresh) == 0) return nullptr;
    front_ = static_cast<std::uint8_t>(middle_.exchange(front_, std::memory_order_acq_rel) & kSlot);
    return &slots_[front_];
  }

 private:
  static constexpr std::uint8_t kSlot = 3, kFresh = 4;
  std::array<T, 3> slots_{};
  std::atomic<std::uint8_t> middle_{1};
  std::uint8_t back_ = 0, front_ = 2;
};

}  // namespace servogate::drivers
