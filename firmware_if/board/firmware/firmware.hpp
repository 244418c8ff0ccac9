// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware_if/board/firmware/hardware.hpp"
#include "firmware_if/board/firmware/step_generator.hpp"
#include "firmware_if/board/protocol/bytes.hpp"
#include "firmware_if/board/protocol/messages.hpp"

namespace servogate::board {

/// The reference firmware of a servogate board: no operating system, no heap, no library beyond memcpy and
/// memset. The main loop hands it each message of the out pipe and sends what it answers; a timer calls
/// tick(). The two must not interrupt one another: receive() is called with the timer's interrupt off, which
/// takes some microseconds. From power-on, after a configuration, after `leave` and after the watchdog
/// everything is dropped: enables off, set-points 0, outputs at their safe levels.
class Firmware {
 public:
  /// `description`: what the hardware has; protocol and max_step_rate are filled in here. `tick_hz`: of the
  /// timer, 10 000 to 200 000.
  Firmware(Hardware& hardware, const Description& description, std::uint32_t tick_hz) noexcept;

  /// A message came. How many bytes of `answer` (kMostBytes long) are to be sent, never 0.
  std::size_t receive(std::span<const std::uint8_t> message, std::span<std::uint8_t> answer) noexcept;
  /// Of the timer: steps, edges, watchdog.
  void tick() noexcept;
  /// An input changed at this time of the board's clock. Not while receive() or tick() runs.
  void note_edge(std::uint8_t input, bool level, std::uint32_t t_us) noexcept;
  bool tripped() const noexcept { return tripped_; }

 private:
  struct Channel {
    ChannelSetting setting;
    StepGenerator steps;
    bool enabled = false, armed = false, limited = false;
    std::int32_t latched = 0;
    std::uint8_t latches = 0;
    std::int32_t offset = 0, stuck_at = 0;  ///< injected
    bool stuck = false, fault = false;      ///< injected
  };
  Configured configure(const Configuration& configuration) noexcept;
  Configured check(const Configuration& configuration) const noexcept;
  void carry_out(const Command& command) noexcept;
  void carry_out(std::size_t number, Channel& channel, const Command& command) noexcept;
  Status status() noexcept;
  bool inject(const Injection& injection) noexcept;
  void clear_injections() noexcept;
  void drop() noexcept;
  void rest(std::size_t number, Channel& channel) noexcept;
  void put_outputs(std::uint32_t levels) noexcept;
  std::uint32_t inputs(std::uint32_t t_us) noexcept;
  std::int32_t counts(std::size_t channel) noexcept;
  bool faulty(std::size_t channel) noexcept;
  void find_edges(std::uint32_t levels, std::uint32_t t_us) noexcept;
  std::uint32_t ticks(std::uint32_t us) const noexcept;

  static constexpr std::size_t kKept = 32;  ///< edges between two commands

  Hardware& hardware_;
  Description description_;
  std::uint32_t tick_hz_;
  Configuration configuration_;
  std::array<Channel, kChannels> channels_{};
  bool configured_ = false, commanded_ = false, tripped_ = false;
  std::uint32_t silent_ticks_ = 0, watchdog_ticks_ = 0;
  std::uint16_t trips_ = 0, lost_edges_ = 0;
  std::uint32_t last_inputs_ = 0;
  bool inputs_known_ = false;
  std::array<InputEdge, kKept> edges_{};
  std::size_t edge_count_ = 0;
  // Injected faults, one bit an input or output.
  std::uint32_t inputs_low_ = 0, inputs_high_ = 0, inputs_chatter_ = 0, outputs_low_ = 0, outputs_high_ = 0;
  std::array<std::uint32_t, kInputs> chatter_us_{};
  std::uint8_t analog_injected_ = 0;
  std::array<std::int16_t, kAnalog> analog_value_{};
};

}  // namespace servogate::board
