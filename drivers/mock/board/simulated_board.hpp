// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/mock/board/amplifier.hpp"
#include "firmware_if/board/firmware/firmware.hpp"
#include "firmware_if/board/master/port.hpp"
#include "firmware_if/image/simulated.hpp"

namespace servogate::mock {

struct SimulatedBoardConfig {
  std::string serial = "mock";
  std::uint32_t tick_hz = 50'000;
  std::uint8_t inputs = 32, outputs = 32;
  /// nullopt: there is no such channel.
  std::array<std::optional<AmplifierConfig>, board::kChannels> amplifiers{};
};

/// The firmware on simulated pins, counters and motors. Time passes in advance_to() only, in ticks of the
/// board's timer; a message is answered when it comes.
class SimulatedBoard final : public image::Simulated, private board::Hardware {
 public:
  explicit SimulatedBoard(const SimulatedBoardConfig& config);
  SimulatedBoard(const SimulatedBoard&) = delete;
  SimulatedBoard& operator=(const SimulatedBoard&) = delete;

  void advance_to(image::Nanoseconds t) override;
  /// A message of the out pipe; its answer, empty: the board is unplugged. real-time safe.
  std::span<const std::uint8_t> exchange(std::span<const std::uint8_t> message) noexcept;

  /// The wire at a digital input changed at time t.
  void set_input(std::size_t number, bool level, image::Nanoseconds t) noexcept;
  bool input(std::size_t number) const noexcept { return (inputs_ >> number & 1u) != 0; }
  bool output(std::size_t number) const noexcept { return (outputs_ >> number & 1u) != 0; }
  void set_analog_input(std::size_t number, std::int16_t value) noexcept { analog_in_[number] = value; }
  std::int16_t analog_output(std::size_t number) const noexcept { return analog_out_[number]; }
  /// nullptr: there is no such channel.
  Amplifier* amplifier(std::size_t channel) noexcept;
  const Amplifier* amplifier(std::size_t channel) const noexcept;

  /// Unplugged, it answers nothing and its watchdog runs; plugged in, it is the one it was.
  void plug(bool plugged) noexcept { plugged_ = plugged; }
  /// Edges and their times get lost, levels do not.
  void lose_edges(bool lost) noexcept { edges_lost_ = lost; }
  /// Loses its voltage for a moment: the firmware begins anew, motors stand where they were.
  void restart();
  /// As the message `inject` does. False: there is no such line.
  bool inject(const board::Injection& injection) noexcept;
  const board::Firmware& firmware() const noexcept { return *firmware_; }

 private:
  std::uint32_t time_us() noexcept override {
    return static_cast<std::uint32_t>(t_ns_ / image::kMicrosecond);
  }
  std::uint32_t inputs() noexcept override { return inputs_; }
  bool tells_edges() noexcept override { return true; }
  void set_outputs(std::uint32_t levels) noexcept override { outputs_ = levels; }
  std::int16_t analog(std::size_t n) noexcept override { return analog_in_[n]; }
  void set_analog(std::size_t n, std::int16_t value) noexcept override { analog_out_[n] = value; }
  bool fault(std::size_t channel) noexcept override;
  void set_enable(std::size_t channel, bool on) noexcept override;
  std::int32_t counts(std::size_t channel) noexcept override;
  void arm_index(std::size_t channel, bool armed) noexcept override;
  bool take_index(std::size_t channel, std::int32_t& counts) noexcept override;
  void set_step(std::size_t channel, bool step, bool forward) noexcept override;
  void set_value(std::size_t channel, std::int16_t value) noexcept override;
  void set_pwm_hz(std::size_t, std::uint32_t) noexcept override {}
  board::Description description() const;

  SimulatedBoardConfig config_;
  std::array<std::optional<Amplifier>, board::kChannels> amplifiers_;
  std::uint32_t inputs_ = 0, outputs_ = 0;
  std::array<std::int16_t, board::kAnalog> analog_in_{}, analog_out_{};
  image::Nanoseconds t_ns_ = 0, tick_ns_;
  bool plugged_ = true, edges_lost_ = false;
  std::unique_ptr<board::Firmware> firmware_;
  std::array<std::uint8_t, board::kMostBytes> answer_{};
};

/// The pipes between a control and a simulated board: an answer is read in the cycle after its question.
class MockBoardPort final : public board::Port {
 public:
  explicit MockBoardPort(SimulatedBoard& board) : board_(board) {}
  std::size_t read(std::span<std::uint8_t> buffer) noexcept override;
  bool write(std::span<const std::uint8_t> message) noexcept override;

 private:
  static constexpr std::size_t kKept = 4;
  struct Kept {
    std::size_t size = 0;
    std::array<std::uint8_t, board::kMostBytes> bytes{};
  };
  SimulatedBoard& board_;
  std::array<Kept, kKept> answers_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace servogate::mock
