// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace servogate::cycle {

/// A whole-cycle value that one writer publishes wait-free and any number of readers copy. The words are
/// relaxed atomics under a sequence, so a torn copy is noticed and taken again, and no data race exists.
template <typename T>
class Snapshot {
  static_assert(std::is_trivially_copyable_v<T>);
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;

 public:
  /// Publishes a value. real-time safe; one writer.
  void publish(const T& value) noexcept {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    const auto* bytes = reinterpret_cast<const unsigned char*>(&value);
    for (std::size_t i = 0; i < kWords; ++i) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + i * 8, i + 1 < kWords || sizeof(T) % 8 == 0 ? 8 : sizeof(T) % 8);
      words_[i].store(word, std::memory_order_relaxed);
    }
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  /// Copies the newest whole value; spins while the writer is inside. Not for the cycle.
  void read(T& value) const noexcept {
    for (;;) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if ((before & 1) == 0) {
        auto* bytes = reinterpret_cast<unsigned char*>(&value);
        for (std::size_t i = 0; i < kWords; ++i) {
          const std::uint64_t word = words_[i].load(std::memory_order_relaxed);
          std::memcpy(bytes + i * 8, &word, i + 1 < kWords || sizeof(T) % 8 == 0 ? 8 : sizeof(T) % 8);
        }
        std::atomic_thread_fence(std::memory_order_acquire);
        if (sequence_.load(std::memory_order_relaxed) == before) return;
      }
    }
  }

 private:
  std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace servogate::cycle
