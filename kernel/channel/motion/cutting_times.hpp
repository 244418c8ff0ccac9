// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <map>

namespace servogate::channel {

/// How long each row of the tool table has been cutting, that is moving at feed, since the control began. The
/// cycle adds, any other thread reads.
class CuttingTimes {
 public:
  static constexpr std::size_t kMostRows = 128;  ///< further ones are not counted

  /// real-time safe.
  void add(std::int32_t row, double seconds) noexcept {
    if (row <= 0) return;
    std::size_t i = last_;
    if (rows_[i].number.load(std::memory_order_relaxed) != row) {
      for (i = 0; i < rows_.size(); ++i) {
        const std::int32_t n = rows_[i].number.load(std::memory_order_relaxed);
        if (n == row || n == 0) break;
      }
      if (i == rows_.size()) return;
      last_ = i;
      rows_[i].number.store(row, std::memory_order_release);
    }
    std::atomic<double>& sum = rows_[i].seconds;
    sum.store(sum.load(std::memory_order_relaxed) + seconds, std::memory_order_relaxed);
  }
  /// Seconds by row. Not for the cycle.
  std::map<std::int32_t, double> read() const {
    std::map<std::int32_t, double> out;
    for (const Row& row : rows_)
      if (const std::int32_t n = row.number.load(std::memory_order_acquire); n != 0)
        out[n] = row.seconds.load(std::memory_order_relaxed);
    return out;
  }

 private:
  struct Row {
    std::atomic<std::int32_t> number{0};
    std::atomic<double> seconds{0.0};
  };
  std::array<Row, kMostRows> rows_{};
  std::size_t last_ = 0;  ///< the cycle's
};

}  // namespace servogate::channel
