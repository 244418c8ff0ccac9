// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "firmware_if/image/can_bus.hpp"

/// The lines of an adapter on a serial port. Source: Lawicel AB, CAN232 manual version 3, sections "Commands"
/// and "Return". All of it is real-time safe.
namespace servogate::slcan {

inline constexpr char kEnd = '\r';      ///< ends a command and a good answer
inline constexpr char kRefused = '\a';  ///< the whole answer to a command that was refused

/// Longest frame: 'T', 8 digits of the identifier, the length, 8 bytes and kEnd.
inline constexpr std::size_t kLongestFrame = 1 + 8 + 1 + 16 + 1;

/// The command that sends a frame. `out` has kLongestFrame characters; returns how many are used. Error and
/// FD frames have no line: 0.
std::size_t encode(const image::CanFrame& frame, std::span<char> out) noexcept;

/// The digit of the command S for a bit rate in bit/s; nullopt: the protocol has none for it.
std::optional<char> rate_digit(std::uint32_t bit_rate) noexcept;

/// What an adapter says.
struct Answer {
  enum class Kind : std::uint8_t {
    done,     ///< the command before was carried out
    refused,  ///< or was not
    sent,     ///< a frame was taken for sending: "z" or "Z"
    frame,    ///< one was received
    flags,    ///< answer to F
    other,    ///< version, serial number, or nothing that is known
  };
  Kind kind = Kind::other;
  image::CanFrame frame;
  std::uint8_t flags = 0;
};

/// Bits of the answer to F.
namespace flag {
inline constexpr std::uint8_t kReceiveFull = 0x01, kSendFull = 0x02, kWarning = 0x04, kOverrun = 0x08,
                              kPassive = 0x20, kArbitrationLost = 0x40, kBusError = 0x80;
}

/// Puts answers together from what comes in, character by character. A line that is too long or no line of
/// the protocol is Kind::other.
class Reader {
 public:
  /// The answer that this character ends, if it ends one.
  std::optional<Answer> put(char c) noexcept;

 private:
  std::array<char, 64> line_{};
  std::size_t length_ = 0;
};

}  // namespace servogate::slcan
