// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "kernel/axis/axis.hpp"

namespace servogate::axis {

/// Homing of several axes by their order numbers: axes with the same number together, the next number when
/// all of them are done. One failure ends it; the axes under way stop.
class HomingSequence {
 public:
  enum class State : std::uint8_t { idle, running, done, failed };

  /// Begins with the axes whose bit is set. False when one of them cannot begin or the sequence already runs;
  /// then nothing moves. real-time safe.
  bool start(std::span<Axis> axes, std::uint32_t mask) noexcept;
  /// One cycle, after Axis::read and before Axis::command. real-time safe.
  void step(std::span<Axis> axes) noexcept;
  /// Stops the axes under way. real-time safe.
  void abort(std::span<Axis> axes) noexcept;
  State state() const noexcept { return state_; }
  bool running() const noexcept { return state_ == State::running; }
  /// Axes that the last order has not brought to its end: not begun, under way or broken off, as bits.
  std::uint32_t remaining() const noexcept { return remaining_; }

 private:
  bool begin_next(std::span<Axis> axes) noexcept;

  State state_ = State::idle;
  std::uint32_t waiting_ = 0;
  std::uint32_t active_ = 0;
  std::uint32_t remaining_ = 0;
};

}  // namespace servogate::axis
