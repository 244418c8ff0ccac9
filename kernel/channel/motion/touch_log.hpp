// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <mutex>
#include <vector>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::channel {

/// A measuring motion that has touched; machine coordinates, mm or degrees.
struct TouchPlace {
  program::Position from{}, to{};  ///< where it began, and where it would have ended
  program::Position at{};          ///< of the axes that it moved: where they were at the touch
  double feed_mm_min = 0.0;
};

/// Every touch of a process, of programs and by hand, for the report of a run: written by the thread that
/// reads programs, read by any thread outside the cycle.
class TouchLog {
 public:
  /// The first so many are kept.
  static constexpr std::size_t kMost = 10'000;
  void put(const TouchPlace& touch) {
    const std::scoped_lock lock(mutex_);
    if (touches_.size() < kMost) touches_.push_back(touch);
  }
  std::vector<TouchPlace> all() const {
    const std::scoped_lock lock(mutex_);
    return touches_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<TouchPlace> touches_;
};

}  // namespace servogate::channel
