// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::board {

/// Levels of the pins of a step output after a tick.
struct StepPins {
  bool step = false;
  bool forward = true;
};

/// Steps of one channel: reaches each target in equal steps a period after its command, goes on at the rate
/// of the command for one period more, and then runs down to rest by itself until the next command comes. A
/// step is high and low for a number of ticks; the direction changes a tick before the first step. All of it
/// is real-time safe; no division but in follow().
class StepGenerator {
 public:
  struct Setting {
    std::uint32_t tick_hz = 50'000;
    std::uint32_t period_ticks = 50;
    std::uint32_t level_ticks = 1;  ///< that each level of a step lasts at least
    std::uint32_t stop_rate = 0;    ///< steps/s2, 0: at once
  };

  void configure(const Setting& setting) noexcept;
  /// A command came. False: it needs more than the largest rate, with which the generator follows behind.
  bool follow(std::int32_t target, std::int32_t rate) noexcept;
  /// Rest here, in the middle of whatever was under way. The pins as they are to stand.
  StepPins drop() noexcept;
  StepPins tick() noexcept;
  /// That were put out.
  std::int32_t steps() const noexcept { return static_cast<std::int32_t>(out_); }
  /// Steps a second that the pins can make.
  static std::uint32_t largest_rate(const Setting& setting) noexcept;

 private:
  /// Of a step: 32 bits behind the point.
  using Fixed = std::int64_t;
  static constexpr Fixed kOne = Fixed{1} << 32;
  Fixed per_tick(std::int64_t steps_per_second) const noexcept;

  Setting setting_;
  Fixed position_ = 0, rate_ = 0, next_rate_ = 0, most_ = 0, brake_ = 0;
  std::uint32_t left_ = 0, more_ = 0;  ///< ticks to the target, and those at the rate of the command
  std::uint32_t out_ = 0;              ///< runs over
  std::uint32_t wait_ = 0;             ///< ticks until the pins may change
  StepPins pins_;
};

}  // namespace servogate::board
