// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware_if/board/protocol/messages.hpp"

namespace servogate::board {

/// What a maker writes for a microcontroller: pins, counters and converters, without a decision in them. All
/// are called from Firmware::receive() and Firmware::tick(), return at once and do not fail. Whatever the
/// board has not is never called, because Description says so.
class Hardware {
 public:
  /// Runs on from power-on and over after 71 minutes.
  virtual std::uint32_t time_us() noexcept = 0;
  /// Levels of all digital inputs, one bit each.
  virtual std::uint32_t inputs() noexcept = 0;
  /// Edges are told by Firmware::note_edge(), from input capture or an interrupt; false: the firmware looks
  /// for them in each tick.
  virtual bool tells_edges() noexcept { return false; }
  virtual void set_outputs(std::uint32_t levels) noexcept = 0;
  /// Value of an analog input, per kFullScale.
  virtual std::int16_t analog(std::size_t number) noexcept = 0;
  virtual void set_analog(std::size_t number, std::int16_t value) noexcept = 0;

  /// Level of the fault input of a channel's amplifier.
  virtual bool fault(std::size_t channel) noexcept = 0;
  virtual void set_enable(std::size_t channel, bool on) noexcept = 0;
  /// Counter of the channel's encoder, which runs over at 32 bits (a narrower one is extended here).
  virtual std::int32_t counts(std::size_t channel) noexcept = 0;
  /// The counter is to be captured at the next index.
  virtual void arm_index(std::size_t channel, bool armed) noexcept = 0;
  /// True once for each capture.
  virtual bool take_index(std::size_t channel, std::int32_t& counts) noexcept = 0;
  /// The two pins of a step output.
  virtual void set_step(std::size_t channel, bool step, bool forward) noexcept = 0;
  /// Of Output::analog or Output::pwm, per kFullScale.
  virtual void set_value(std::size_t channel, std::int16_t value) noexcept = 0;
  virtual void set_pwm_hz(std::size_t channel, std::uint32_t hz) noexcept = 0;

 protected:
  ~Hardware() = default;
};

}  // namespace servogate::board
