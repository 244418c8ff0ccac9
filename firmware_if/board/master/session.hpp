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

/// The control's side of the conversation: asks for the description until a board answers, configures it, and
/// then sends one command a cycle. A board that restarts or falls silent is described and configured again.
/// All of it is real-time safe.
class Session {
 public:
  explicit Session(const Configuration& configuration) noexcept;

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
  /// What the board said to the configuration; in refused with `done` it speaks another protocol.
  const Configured& configured() const noexcept { return configured_; }
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

  Configuration configuration_;
  image::Nanoseconds silence_ns_;  ///< half of the watchdog: axes stop before it takes their power
  SessionState state_ = SessionState::silent;
  Description description_;
  Configured configured_;
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
