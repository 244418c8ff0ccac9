// SPDX-License-Identifier: Apache-2.0
#include "drivers/gsusb/protocol.hpp"

#include <linux/can.h>
#include <linux/can/error.h>

#include <algorithm>

namespace servogate::gsusb {
namespace {

constexpr std::uint32_t kLittleEndian = 0x0000BEEF;
constexpr std::uint32_t kReset = 0, kStart = 1;
constexpr std::uint8_t kOverflowFlag = 1u << 0, kFdFlag = 1u << 1;

void put(std::span<std::uint8_t> out, std::size_t at, std::uint32_t word) noexcept {
  for (std::size_t i = 0; i < 4; ++i) out[at + i] = static_cast<std::uint8_t>(word >> 8 * i);
}
std::uint32_t word(std::span<const std::uint8_t> in, std::size_t at) noexcept {
  std::uint32_t w = 0;
  for (std::size_t i = 0; i < 4; ++i) w |= static_cast<std::uint32_t>(in[at + i]) << 8 * i;
  return w;
}

}  // namespace

std::array<std::uint8_t, 4> host_format() noexcept {
  std::array<std::uint8_t, 4> out{};
  put(out, 0, kLittleEndian);
  return out;
}

std::array<std::uint8_t, kBitTimingBytes> bit_timing(const BitTiming& t) noexcept {
  std::array<std::uint8_t, kBitTimingBytes> out{};
  put(out, 0, t.propagation);
  put(out, 4, t.phase_1);
  put(out, 8, t.phase_2);
  put(out, 12, t.jump_width);
  put(out, 16, t.prescaler);
  return out;
}

std::array<std::uint8_t, kModeBytes> mode(bool start, std::uint32_t flags) noexcept {
  std::array<std::uint8_t, kModeBytes> out{};
  put(out, 0, start ? kStart : kReset);
  put(out, 4, flags);
  return out;
}

std::optional<DeviceConfig> parse_device_config(std::span<const std::uint8_t> b) noexcept {
  if (b.size() < kDeviceConfigBytes || b[3] == 0xFF) return std::nullopt;
  return DeviceConfig{static_cast<std::uint8_t>(b[3] + 1), word(b, 4), word(b, 8)};
}

std::optional<Limits> parse_limits(std::span<const std::uint8_t> b) noexcept {
  if (b.size() < kLimitsBytes) return std::nullopt;
  return Limits{word(b, 0),
                {word(b, 4), word(b, 8), word(b, 12), word(b, 16), word(b, 20), word(b, 24), word(b, 28),
                 word(b, 32), word(b, 36)}};
}

std::optional<ControllerState> parse_state(std::span<const std::uint8_t> b) noexcept {
  using image::CanState;
  static constexpr CanState kStates[] = {CanState::error_active,  CanState::error_warning,
                                         CanState::error_passive, CanState::bus_off,
                                         CanState::down,          CanState::down};
  if (b.size() < kStateBytes || word(b, 0) >= std::size(kStates)) return std::nullopt;
  return ControllerState{kStates[word(b, 0)], word(b, 4), word(b, 8)};
}

std::optional<std::uint32_t> parse_timestamp(std::span<const std::uint8_t> b) noexcept {
  if (b.size() < kTimestampBytes) return std::nullopt;
  return word(b, 0);
}

std::size_t encode(const image::CanFrame& f, std::uint32_t echo, std::uint8_t channel, std::uint32_t features,
                   std::span<std::uint8_t, kStampedBytes> out) noexcept {
  std::fill(out.begin(), out.end(), std::uint8_t{0});
  put(out, 0, echo);
  put(out, 4,
      (f.id & (f.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) | (f.extended ? CAN_EFF_FLAG : 0u) |
          (f.remote ? CAN_RTR_FLAG : 0u));
  const std::size_t length = std::min<std::size_t>(f.length, CAN_MAX_DLEN);
  out[8] = static_cast<std::uint8_t>(length);
  out[9] = channel;
  if (!f.remote) std::copy_n(f.data.begin(), length, out.begin() + kHeadBytes);
  return (features & feature::kOneByteMore) != 0 ? kPaddedBytes : kFrameBytes;
}

bool decode(std::span<const std::uint8_t> b, bool stamped, HostFrame& out) noexcept {
  if (b.size() < kHeadBytes || b[8] > CAN_MAX_DLEN || (b[10] & kFdFlag) != 0) return false;
  out = {};
  out.echo = word(b, 0);
  out.channel = b[9];
  out.overflow = (b[10] & kOverflowFlag) != 0;
  const std::uint32_t id = word(b, 4);
  image::CanFrame& f = out.frame;
  f.error = (id & CAN_ERR_FLAG) != 0;
  f.extended = !f.error && (id & CAN_EFF_FLAG) != 0;
  f.remote = !f.error && (id & CAN_RTR_FLAG) != 0;
  f.id = id & (f.error ? CAN_ERR_MASK : f.extended ? CAN_EFF_MASK : static_cast<std::uint32_t>(CAN_SFF_MASK));
  f.length = b[8];
  // Behind the data stands the time, so a stamped transfer has room for all eight bytes.
  const std::size_t data = out.echo != HostFrame::kReceived || f.remote ? 0 : f.length;
  if (b.size() < (stamped ? kStampedBytes : kHeadBytes + data)) return false;
  std::copy_n(b.begin() + kHeadBytes, data, f.data.begin());
  if (stamped) out.timestamp_us = word(b, kFrameBytes);
  return true;
}

image::CanState state_after(const image::CanFrame& error, image::CanState before) noexcept {
  using image::CanState;
  if (error.id & CAN_ERR_BUSOFF) return CanState::bus_off;
  if (error.id & CAN_ERR_RESTARTED) return CanState::error_active;
  if (!(error.id & CAN_ERR_CRTL)) return before;
  const unsigned detail = error.data[1];
  if (detail & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) return CanState::error_passive;
  if (detail & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) return CanState::error_warning;
  if (detail & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) return before;
  return CanState::error_active;  // a controller word without a warning: it has recovered
}

image::CanFrame restarted() noexcept {
  image::CanFrame f;
  f.error = true;
  f.id = CAN_ERR_RESTARTED;
  f.length = CAN_ERR_DLC;
  return f;
}

}  // namespace servogate::gsusb
