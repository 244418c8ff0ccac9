// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/time.hpp"

namespace servogate::mock {

/// A turret or magazine that turns one way while its motor is on. From one position to the next it takes
/// `step_ns`; no position switch is on for the first half of that way, the next position's for the second.
/// Where the motor stops the indexer stays.
class Indexer {
 public:
  /// `positions` >= 1, `step_ns` >= 2, `start` in [0, positions).
  Indexer(int positions, image::Nanoseconds step_ns, int start = 0);

  /// Time passes up to `t` (never backwards) with the motor as it was told here the time before.
  void advance_to(image::Nanoseconds t, bool motor) noexcept;
  /// Position whose switch is on, -1: between two.
  int position() const noexcept;
  bool turns() const noexcept { return motor_; }

 private:
  int positions_;
  image::Nanoseconds step_ns_;
  image::Nanoseconds turned_ns_;  ///< of one turn, from position 0
  image::Nanoseconds t_ns_ = 0;
  bool motor_ = false;
};

}  // namespace servogate::mock
