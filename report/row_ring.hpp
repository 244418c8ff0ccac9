// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>

namespace servogate::report {

/// Which slots of a ring a producer, the cycle, and a consumer, the writer's thread, may touch: row n lies in
/// slot n % slots, of which all exist from the start, so that no page is touched for the first time inside a
/// cycle. The producer never wakes anybody: that would be a system call.
class RowRing {
 public:
  /// At least one.
  explicit RowRing(std::size_t slots) : slots_(std::max<std::size_t>(slots, 1)) {}

  std::size_t slots() const noexcept { return slots_; }
  /// Of the producer: where its next row goes; nullopt: no room, the row is lost and counted. real-time safe.
  std::optional<std::size_t> slot() noexcept {
    if (has_room()) return static_cast<std::size_t>(accepted_.load(std::memory_order_relaxed) % slots_);
    lose();
    return std::nullopt;
  }
  /// Hands over the row in slot(). real-time safe.
  void commit() noexcept {
    accepted_.store(accepted_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  /// Counts what found no room. real-time safe.
  void lose() noexcept { lost_.fetch_add(1, std::memory_order_relaxed); }
  /// Of the producer's thread. real-time safe.
  bool has_room() const noexcept {
    return accepted_.load(std::memory_order_relaxed) - consumed_.load(std::memory_order_acquire) < slots_;
  }
  /// Of the producer's thread: blocks until it has room.
  void wait_for_room() const {
    for (;;) {
      const std::uint64_t done = consumed_.load(std::memory_order_acquire);
      if (accepted_.load(std::memory_order_relaxed) - done < slots_) return;
      consumed_.wait(done, std::memory_order_acquire);
    }
  }

  /// Of the consumer: gives the slots of at most `most` rows to `take`, in their order; how many it were.
  template <typename Take>
  std::size_t drain(std::size_t most, Take&& take) {
    const std::uint64_t from = consumed_.load(std::memory_order_relaxed);
    const std::uint64_t to = std::min<std::uint64_t>(accepted_.load(std::memory_order_acquire), from + most);
    for (std::uint64_t n = from; n < to; ++n) {
      take(static_cast<std::size_t>(n % slots_));
      consumed_.store(n + 1, std::memory_order_release);
    }
    if (to > from) consumed_.notify_one();
    return static_cast<std::size_t>(to - from);
  }

  std::uint64_t accepted() const noexcept { return accepted_.load(std::memory_order_relaxed); }
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  std::size_t slots_;
  alignas(64) std::atomic<std::uint64_t> accepted_{0};  ///< written by the producer alone
  alignas(64) std::atomic<std::uint64_t> consumed_{0};  ///< written by the consumer alone
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace servogate::report
