// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

namespace servogate::canopen {

/// Records of interpolated position mode on their way to the generator, 60C4h. real-time safe.
class InterpolationBuffer {
 public:
  static constexpr std::uint32_t kMost = 64;  ///< 60C4h:01
  enum class Organisation : std::uint8_t { fifo = 0, ring = 1 };

  /// 60C4h:02 and :03 were written; what is inside is lost.
  void configure(std::uint32_t size, Organisation organisation) noexcept {
    size_ = size < 1 ? 1 : size > kMost ? kMost : size;
    organisation_ = organisation;
    clear();
  }
  void clear() noexcept { first_ = count_ = 0; }
  /// 60C4h:06: 0 clears the buffer and closes it, 1 opens it.
  void open(bool opened) noexcept {
    if (!opened) clear();
    opened_ = opened;
  }
  bool opened() const noexcept { return opened_; }
  std::uint32_t count() const noexcept { return count_; }
  /// A buffer of one record holds the newest; a ring gives up its oldest; a full FIFO takes no more.
  bool takes_more() const noexcept {
    return opened_ && (size_ == 1 || organisation_ == Organisation::ring || count_ < size_);
  }
  bool push(std::int64_t record) noexcept {
    if (!takes_more()) return false;
    if (count_ == size_) {
      first_ = (first_ + 1) % kMost;
      --count_;
    }
    records_[(first_ + count_++) % kMost] = record;
    return true;
  }
  /// `count()` > 0.
  std::int64_t pop() noexcept {
    const std::int64_t record = records_[first_];
    first_ = (first_ + 1) % kMost;
    --count_;
    return record;
  }

 private:
  std::array<std::int64_t, kMost> records_{};
  std::uint32_t first_ = 0, count_ = 0, size_ = 1;
  Organisation organisation_ = Organisation::fifo;
  bool opened_ = true;
};

}  // namespace servogate::canopen
