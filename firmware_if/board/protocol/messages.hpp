// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

/// What goes over the two bulk pipes of a servogate board, as values. The byte layout is
/// firmware_if/board/README.md, "Messages"; both ends are here, so that firmware and control cannot differ.
/// Freestanding: no allocation, no exception, no library function. Everything here is real-time safe.
namespace servogate::board {

/// Of this layout. A board of another one is refused.
inline constexpr std::uint16_t kProtocolVersion = 1;

inline constexpr std::size_t kInputs = 32;
inline constexpr std::size_t kOutputs = 32;
inline constexpr std::size_t kAnalog = 4;    ///< analog inputs, and analog outputs beside those of channels
inline constexpr std::size_t kChannels = 4;  ///< each: set-point out, encoder in, enable out, fault in
inline constexpr std::size_t kEdges = 8;     ///< in one status
inline constexpr std::size_t kSerialBytes = 16;
inline constexpr std::int16_t kFullScale = 32767;  ///< of analog values and duty cycles: the largest there is

/// Of the interface, by which a control finds the board whatever its vendor and product number.
inline constexpr std::uint8_t kInterfaceClass = 0xFF, kInterfaceSubclass = 0x53, kInterfaceProtocol = 0x47;

/// What a set-point channel can be.
enum class Output : std::uint8_t { off, step, analog, pwm };
constexpr std::uint8_t capability(Output output) noexcept {
  return static_cast<std::uint8_t>(1u << static_cast<unsigned>(output));
}
/// Beside the outputs in Description::capabilities.
inline constexpr std::uint8_t kHasEncoder = 0x10, kHasIndex = 0x20;

enum class Kind : std::uint8_t {
  describe = 0x01,   ///< who are you -> Description
  configure = 0x02,  ///< Configuration -> Configured; outputs drop, the watchdog waits for the first cycle
  cycle = 0x03,      ///< Command -> Status
  inject = 0x04,     ///< Injection -> Injected
  leave = 0x05,      ///< the control ends: outputs drop -> left
  description = 0x81,
  configured = 0x82,
  status = 0x83,
  injected = 0x84,
  left = 0x85,
  refused = 0xFF,  ///< a message that is none: Refusal
};

struct Description {
  std::uint16_t protocol = kProtocolVersion;
  std::uint16_t firmware = 0;
  std::uint8_t inputs = 0, outputs = 0, analog_inputs = 0, analog_outputs = 0;
  std::array<std::uint8_t, kChannels> capabilities{};  ///< 0: there is no such channel
  std::uint32_t max_step_rate = 0;                     ///< steps a second
  std::uint16_t full_scale_mv = 0;                     ///< of an analog output at kFullScale
  std::array<char, kSerialBytes> serial{};             ///< filled up with 0
};

struct ChannelSetting {
  Output output = Output::off;
  bool fault_is_low = false;    ///< the fault input reports at level 0 (a break contact: inverted)
  std::uint8_t step_us = 5;     ///< shortest time of a step level, high and low
  std::uint32_t stop_rate = 0;  ///< steps/s2: ramp to rest when commands stay away; 0: at once
  std::uint32_t pwm_hz = 20'000;
};

struct Configuration {
  std::uint32_t period_us = 1000;      ///< between two commands
  std::uint32_t watchdog_us = 20'000;  ///< without a command: everything drops. Not 0
  std::uint32_t safe_outputs = 0;      ///< levels of the digital outputs when dropped
  std::uint32_t edge_mask = 0;         ///< inputs whose edges are told with their times
  std::array<std::int16_t, kAnalog> safe_analog{};
  std::array<ChannelSetting, kChannels> channels{};
};

/// Result of a configuration; `channel` for what is wrong with one.
enum class ConfigureResult : std::uint8_t { done, no_watchdog, no_period, no_such_channel, no_such_output };
struct Configured {
  ConfigureResult result = ConfigureResult::done;
  std::uint8_t channel = 0;
};

struct ChannelCommand {
  /// step: steps from where the board was configured, to be reached a period after the command; analog, pwm:
  /// per kFullScale.
  std::int32_t target = 0;
  std::int32_t rate = 0;  ///< step: steps/s at the target, with which it goes on until the next command
};

/// Bits of Command::flags.
inline constexpr std::uint8_t kResetTrip = 0x01;  ///< ends the trip of the watchdog

struct Command {
  std::uint32_t outputs = 0;
  std::uint8_t enable = 0;  ///< one bit a channel
  std::uint8_t latch = 0;   ///< one bit a channel: arms one capture at the index
  std::uint8_t flags = 0;
  std::array<std::int16_t, kAnalog> analog{};
  std::array<ChannelCommand, kChannels> channels{};
};

/// A digital input changed.
struct InputEdge {
  std::uint8_t input = 0;
  bool level = false;
  std::uint32_t t_us = 0;  ///< of the board's clock
};

struct ChannelStatus {
  std::int32_t counts = 0;  ///< of the encoder, which runs over
  std::int32_t steps = 0;   ///< that were put out since the board was configured
  std::int32_t latched = 0;
  std::uint8_t latches = 0;  ///< rises with each capture, and runs over
};

/// Bits of Status::flags.
inline constexpr std::uint8_t kTripped = 0x01;     ///< the watchdog has dropped everything
inline constexpr std::uint8_t kConfigured = 0x02;  ///< since the board started
inline constexpr std::uint8_t kInjected = 0x04;    ///< a fault is injected on one of its lines

struct Status {
  std::uint32_t t_us = 0;  ///< of the board's clock when it took the command; all values are of that time
  std::uint32_t inputs = 0;
  std::uint8_t flags = 0;
  std::uint8_t faults = 0;       ///< one bit a channel: its fault input
  std::uint8_t enabled = 0;      ///< one bit a channel: its enable output
  std::uint8_t limited = 0;      ///< one bit a channel: a target needed more than the largest step rate
  std::uint16_t lost_edges = 0;  ///< since the board was configured; runs over
  std::uint16_t trips = 0;       ///< of the watchdog since the board started; runs over
  std::array<std::int16_t, kAnalog> analog{};
  std::array<ChannelStatus, kChannels> channels{};
  std::uint8_t edge_count = 0;
  std::array<InputEdge, kEdges> edges{};
};

/// A fault on a line of the board, for tests of what is wired to it.
enum class Fault : std::uint8_t {
  none,           ///< ends what was injected on this line; on number 255: on all
  input_low,      ///< digital input `number` reads 0
  input_high,     ///< ... 1
  input_chatter,  ///< ... changes every `value` us
  output_low,     ///< digital output `number` stays 0
  output_high,    ///< ... 1
  analog_value,   ///< analog input `number` reads `value`
  encoder_stuck,  ///< the counter of channel `number` stands still
  encoder_jump,   ///< ... jumps by `value` counts, once
  drive_fault,    ///< the fault input of channel `number` reports
};
struct Injection {
  Fault fault = Fault::none;
  std::uint8_t number = 255;
  std::int32_t value = 0;
};

enum class Reason : std::uint8_t { unknown_kind, wrong_length, not_configured };
struct Refusal {
  std::uint8_t kind = 0;
  Reason reason = Reason::unknown_kind;
};

}  // namespace servogate::board
