// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/image/time.hpp"

namespace servogate::image {

/// Flags of an FD frame, numbered as in linux/can.h and in a log of candump: the data was sent at the second
/// bit rate (BRS); its sender is error-passive (ESI).
inline constexpr std::uint8_t kBitRateSwitch = 1, kErrorStateIndicator = 2;

/// One CAN frame, classic or FD. `id` has 11 bits, or 29 when `extended`.
struct CanFrame {
  std::uint32_t id = 0;
  bool extended = false;
  bool remote = false;
  bool fd = false;
  bool error = false;  ///< an error frame of the interface, not data
  std::uint8_t length = 0;
  std::array<std::uint8_t, 64> data{};
  std::uint8_t fd_flags = 0;  ///< kBitRateSwitch, kErrorStateIndicator; 0 for a classic frame
  /// Bits from start of frame to end of frame with its own stuff bits, where somebody has counted them
  /// already (can_wire.hpp); 0: not counted. Whoever changes the frame sets it back to 0.
  std::uint16_t wire_bits = 0;
  /// End of frame on the wire as the transport knows it: simulated time on a mock bus, CLOCK_MONOTONIC on a
  /// transport of the computer (a time stamp of another clock is converted when the frame is read).
  Nanoseconds timestamp_ns = 0;
};

/// The bits by which frames compete, in their order on the wire: base identifier, RTR or SRR, IDE, identifier
/// extension, RTR. The smaller number wins. Source: ISO 11898-1, 10.4.2. real-time safe.
constexpr std::uint32_t arbitration_key(const CanFrame& f) noexcept {
  const std::uint32_t rtr = f.remote ? 1 : 0;
  if (!f.extended) return (f.id & 0x7FF) << 21 | rtr << 20;
  return (f.id >> 18 & 0x7FF) << 21 | 3u << 19 | (f.id & 0x3FFFF) << 1 | rtr;
}

/// Health of a bus as its transport sees it.
enum class CanState : std::uint8_t { error_active, error_warning, error_passive, bus_off, down };

/// The one interface of every CAN transport: mock, SocketCAN, user-space, USB adapter.
class CanBus {
 public:
  virtual ~CanBus() = default;
  /// Queues a frame. False: the queue is full, nothing was queued. real-time safe.
  virtual bool send(const CanFrame& frame) noexcept = 0;
  /// Takes the oldest received frame. False: none is waiting. Own frames are not received. real-time safe.
  virtual bool receive(CanFrame& frame) noexcept = 0;
  virtual CanState state() const noexcept = 0;
  /// Nominal bit rate in bit/s. real-time safe.
  virtual std::uint32_t bit_rate() const noexcept = 0;
  /// Frames that this transport knows to be lost on the computer's side, sent or received: an overflowing
  /// buffer, a queue emptied when the link went down. Never a frame that send() refused. real-time safe.
  virtual std::uint64_t lost() const noexcept { return 0; }
  /// Whether CAN FD frames pass; where they do not, send() refuses each. real-time safe.
  virtual bool carries_fd() const noexcept { return false; }
};

/// Worst-case length on the wire in bits of a classic data frame, stuff bits and the interframe space
/// included. Source: ISO 11898-1; 8n + 47 + floor((34 + 8n - 1) / 4) for 11-bit, 8n + 67 + floor((54 + 8n -
/// 1) / 4) for 29-bit.
constexpr std::uint32_t worst_case_bits(std::uint32_t payload_bytes, bool extended = false) noexcept {
  const std::uint32_t stuffed = (extended ? 54 : 34) + 8 * payload_bytes;
  return 8 * payload_bytes + (extended ? 67 : 47) + (stuffed - 1) / 4;
}

}  // namespace servogate::image
