// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "firmware_if/board/protocol/bytes.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::board {

enum class SessionState : std::uint8_t {
  silent,       ///< nothing was heard of the board yet, or for longer than half of its watchdog
  configuring,  ///< it has described itself
  running,      ///< it answers each command
  refused,      ///< it speaks another protocol or cannot do what the machine file wants
};

/// What the machine file wants of a board beside its configuration. Numbers of lines are counts from line 0
/// on.
struct Needs {
  std::uint8_t inputs = 0, outputs = 0, analog_inputs = 0, analog_outputs = 0;
  std::uint8_t encoders = 0;    ///< channels whose encoder is read, bit n
  std::uint32_t step_rate = 0;  ///< steps/s of the fastest axis
};

/// Why a session is refused; `wanted` and `has` are a channel, a number of lines, steps/s or a version.
enum class RefusedFor : std::uint8_t {
  none,
  protocol,
  watchdog,
  period,
  channel,
  output,
  encoder,
  step_rate,
  inputs,
  outputs,
  analog_inputs,
  analog_outputs
};
struct Refused {
  RefusedFor why = RefusedFor::none;
  std::uint32_t wanted = 0, has = 0;
};

/// The control's side of the conversation: asks for the description until a board answers, configures it, and
/// then sends one command a cycle. A board that restarts or falls silent is described and configured again,
/// one that refused every two seconds. All of it is real-time safe.
class Session {
 public:
  explicit Session(const Configuration& configuration, const Needs& needs = {}) noexcept;

  /// What the port has read at machine time `t`. True: it was a status.
  bool take(std::span<const std::uint8_t> bytes, image::Nanoseconds t) noexcept;
  /// The message of this cycle, into `buffer`; 0: there is none to send.
  std::size_t next(const Command& command, image::Nanoseconds t, std::span<std::uint8_t> buffer) noexcept;

  SessionState state() const noexcept { return state_; }
  /// Newest status of this session; meaningful while it is running.
  const Status& status() const noexcept { return status_; }
  /// A status was taken since the last call.
  bool take_fresh() noexcept;
  const Description& description() const noexcept { return description_; }
  /// Meaningful while it is refused.
  const Refused& refused() const noexcept { return refused_; }
  /// Rises with every configuration: counters began anew.
  std::uint32_t sessions() const noexcept { return sessions_; }
  /// Machine time of a stamp of the board's clock in the newest status, or shortly before.
  image::Nanoseconds machine_time(std::uint32_t t_us) const noexcept;

 private:
  static constexpr std::uint32_t kSent = 32;     ///< commands whose time is remembered
  static constexpr std::uint32_t kWindow = 256;  ///< statuses in which the shortest way is sought
  void take_description(std::span<const std::uint8_t> body, image::Nanoseconds t) noexcept;
  void take_configured(const Message& message, image::Nanoseconds t) noexcept;
  void take_status(std::uint32_t sequence, image::Nanoseconds t) noexcept;
  void begin() noexcept;
  Refused lack() const noexcept;

  Configuration configuration_;
  Needs needs_;
  image::Nanoseconds silence_ns_;  ///< half of the watchdog: axes stop before it takes their power
  SessionState state_ = SessionState::silent;
  Description description_;
  Refused refused_;
  Status status_;
  bool fresh_ = false;
  std::uint32_t sessions_ = 0;
  std::uint32_t sequence_ = 0, configure_sequence_ = 0;
  image::Nanoseconds asked_ns_ = -image::kSecond, heard_ns_ = 0;
  std::array<image::Nanoseconds, kSent> sent_ns_{};
  // The board's clock, extended, against machine time: the least that a command needed to arrive counts.
  std::int64_t board_us_ = 0;
  std::uint32_t stamps_ = 0;
  image::Nanoseconds ahead_ns_ = 0, ahead_before_ns_ = 0;
  bool ahead_known_ = false;
};

}  // namespace servogate::board
