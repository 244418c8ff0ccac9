// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "kernel/axis/axis.hpp"

namespace servogate::channel {

/// The way by which axes were jogged away from the path of a held program, as legs of one axis each, and the
/// motion back: the same legs, the last one first, so that nothing is passed that was not passed on the way
/// out. All functions are real-time safe.
class WayBack {
 public:
  static constexpr std::size_t kMostLegs = 128;

  void clear() noexcept {
    count_ = 0;
    returns_ = moves_ = false;
  }
  /// Axis `axis` leaves `from` (machine coordinates); a leg of the same axis goes on. Not when full() and the
  /// last leg is another axis'.
  void leave(int axis, double from) noexcept;
  bool away() const noexcept { return count_ != 0; }
  bool full() const noexcept { return count_ == legs_.size(); }
  bool returns() const noexcept { return returns_; }
  /// Axis of the last leg and where that begins; only while away().
  int axis() const noexcept { return legs_[count_ - 1].axis; }
  double from() const noexcept { return legs_[count_ - 1].from; }

  /// Returns at `velocity` (mm/s or degrees/s, at most the jog speed of each axis; 0: that speed) in the next
  /// steps. A stop of the axis ends it where it is; what is left of the way is kept.
  void begin(double velocity) noexcept {
    velocity_ = velocity;
    returns_ = away();
    moves_ = false;
  }
  /// One cycle, with the axes of the machine. A leg that is undone, by this or by hand, is dropped.
  void step(std::span<axis::Axis> axes) noexcept;

 private:
  struct Leg {
    std::int8_t axis = 0;
    double from = 0.0;
  };
  std::array<Leg, kMostLegs> legs_{};
  std::size_t count_ = 0;
  double velocity_ = 0.0;
  bool returns_ = false;
  bool moves_ = false;  ///< the leg under way was begun
};

}  // namespace servogate::channel
