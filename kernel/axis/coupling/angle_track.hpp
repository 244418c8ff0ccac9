// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/time.hpp"

namespace servogate::axis {

/// A commanded angle in revolutions from a zero of its own, with its recent past. All functions are real-time
/// safe.
class AngleTrack {
 public:
  bool begun() const noexcept { return count_ > 0; }
  void forget() noexcept { count_ = 0; }
  /// It is at `turns` at that time.
  void put(double turns, image::Nanoseconds t_ns) noexcept;
  /// The newest angle; only once begun.
  double newest() const noexcept { return places_[static_cast<std::size_t>(head_)].turns; }
  image::Nanoseconds newest_ns() const noexcept { return places_[static_cast<std::size_t>(head_)].t_ns; }
  /// The angle at a time, between the values around it; before and behind them by the nearest two.
  double at(image::Nanoseconds t_ns) const noexcept;

 private:
  static constexpr int kKept = 64;  // cycles: more than any dead time
  struct Place {
    double turns = 0.0;
    image::Nanoseconds t_ns = 0;
  };
  const Place& ago(int n) const noexcept {
    return places_[static_cast<std::size_t>((head_ - n + kKept) % kKept)];
  }
  std::array<Place, kKept> places_{};
  int head_ = 0, count_ = 0;
};

}  // namespace servogate::axis
