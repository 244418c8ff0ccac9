// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>

namespace servogate::plc {

/// Scans as somebody outside of their thread sees them, and the one thing he may do to them: end the one
/// under way. The instruction budget bounds a scan by what it executes; this bounds it by whatever the one
/// outside measures. All real-time safe.
class ScanWatch {
 public:
  /// Number of the scan under way, 0: none. Numbers rise by one and never come again. Any thread.
  std::uint64_t under_way() const noexcept { return under_way_.load(std::memory_order_relaxed); }
  /// Ends the scan of this number at its next backward jump, call or block copy: Fault::overrun. One that is
  /// over, and every other, does not notice. Any thread.
  void end(std::uint64_t scan) noexcept { ended_.store(scan, std::memory_order_relaxed); }

  /// The scans' own thread: the number of the one that begins.
  std::uint64_t begin() noexcept {
    under_way_.store(++count_, std::memory_order_relaxed);
    return count_;
  }
  void close() noexcept { under_way_.store(0, std::memory_order_relaxed); }
  /// Has the next scan end before it does anything; a replay of one that was ended.
  void end_next() noexcept { end(count_ + 1); }
  /// The scan that somebody has ended.
  const std::atomic<std::uint64_t>& ended() const noexcept { return ended_; }

 private:
  std::uint64_t count_ = 0;
  std::atomic<std::uint64_t> under_way_{0}, ended_{0};
};

}  // namespace servogate::plc
