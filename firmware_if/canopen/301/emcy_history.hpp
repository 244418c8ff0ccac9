// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/301/emcy.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// The last emergency messages of a node, newest first, as its own 1003h keeps them. All members are
/// real-time safe.
class EmcyHistory {
 public:
  static constexpr std::size_t kSize = 8;
  struct Item {
    Emcy emcy;
    image::Nanoseconds t_ns = 0;
  };

  void add(const Emcy& emcy, image::Nanoseconds t_ns) noexcept {
    newest_ = (newest_ + kSize - 1) % kSize;
    items_[newest_] = {emcy, t_ns};
    ++count_;
  }
  /// Messages since the start.
  std::uint32_t count() const noexcept { return count_; }
  /// Kept messages.
  std::size_t size() const noexcept { return count_ < kSize ? count_ : kSize; }
  /// i-th newest, i < size().
  const Item& operator[](std::size_t i) const noexcept { return items_[(newest_ + i) % kSize]; }

 private:
  std::array<Item, kSize> items_{};
  std::size_t newest_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace servogate::canopen
