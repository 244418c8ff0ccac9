// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

namespace servogate::plc {

/// The bytes of all retained variables on their way out of the cycle: one writer that never waits, any number
/// of readers that get the values of one scan, never a mixture of two. The words are relaxed atomics under a
/// sequence; how many there are is known only when a program is there.
class RetainedMemory {
 public:
  explicit RetainedMemory(std::size_t bytes) : newest_(bytes), words_((bytes + 7) / 8) {}

  /// Where the writer puts the values of a scan before publish(). real-time safe.
  std::span<std::uint8_t> scratch() noexcept { return newest_; }
  /// Makes the scratch the newest values when anything in it has changed. real-time safe; one writer.
  void publish() noexcept;

  /// Number of the newest values, 0: none yet. real-time safe.
  std::uint64_t version() const noexcept { return sequence_.load(std::memory_order_acquire) / 2; }
  /// Copies the newest values; spins while the writer is inside. Returns their number. Not for the cycle.
  std::uint64_t read(std::vector<std::uint8_t>& out) const;

 private:
  std::uint64_t word(std::size_t index) const noexcept;

  std::vector<std::uint8_t> newest_;
  std::vector<std::atomic<std::uint64_t>> words_;
  std::atomic<std::uint64_t> sequence_{0};
};

}  // namespace servogate::plc
