// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace servogate::board {

/// The two pipes of a board as the cycle sees them: a USB device behind a thread, or a simulated one.
class Port {
 public:
  virtual ~Port() = default;
  /// The oldest message that has come, into a buffer of kMostBytes; how many bytes, 0: none. real-time safe.
  virtual std::size_t read(std::span<std::uint8_t> buffer) noexcept = 0;
  /// Puts a message on its way. False: too many are under way, or the board is gone. real-time safe.
  virtual bool write(std::span<const std::uint8_t> message) noexcept = 0;
};

}  // namespace servogate::board
