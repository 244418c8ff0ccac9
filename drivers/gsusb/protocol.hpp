// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/gsusb/bit_timing.hpp"
#include "firmware_if/image/can_bus.hpp"

/// Bytes that pass between a computer and a USB-CAN adapter of the gs_usb class (candleLight and its kin).
/// Words are little-endian. Source: the protocol as the firmware candleLight_fw and Linux' gs_usb speak it.
namespace servogate::gsusb {

/// bRequest of a vendor request to the interface; wValue is the channel, 1 for the first two in `per device`.
enum class Request : std::uint8_t {
  host_format = 0,    ///< out, per device
  bit_timing = 1,     ///< out
  mode = 2,           ///< out
  limits = 4,         ///< in: what bit timing can be set, features
  device_config = 5,  ///< in, per device
  timestamp = 6,      ///< in: the adapter's clock, µs
  get_state = 14,     ///< in: state and error counters
};

/// Bits of Limits::feature; those of mode() flags are the same.
namespace feature {
inline constexpr std::uint32_t kListenOnly = 1u << 0, kHardwareTimestamp = 1u << 4;
/// One more byte behind each frame that is sent, for a controller that loses full packets.
inline constexpr std::uint32_t kOneByteMore = 1u << 9;
inline constexpr std::uint32_t kGetState = 1u << 13;
}  // namespace feature

/// Who the adapter is.
struct DeviceConfig {
  std::uint8_t channels = 1;
  std::uint32_t software = 0;
  std::uint32_t hardware = 0;
};

/// What Request::limits answers.
struct Limits {
  std::uint32_t feature = 0;
  TimingLimits timing;
};

/// What Request::get_state answers.
struct ControllerState {
  image::CanState state = image::CanState::error_active;
  std::uint32_t receive_errors = 0;
  std::uint32_t transmit_errors = 0;
};

inline constexpr std::size_t kDeviceConfigBytes = 12, kLimitsBytes = 40, kStateBytes = 12,
                             kTimestampBytes = 4, kBitTimingBytes = 20, kModeBytes = 8;
/// A frame on the bulk pipes, without and with time stamp, and with the byte of kOneByteMore.
inline constexpr std::size_t kHeadBytes = 12, kFrameBytes = 20, kStampedBytes = 24, kPaddedBytes = 21;

/// Content of Request::host_format: tells the adapter the order of bytes.
std::array<std::uint8_t, 4> host_format() noexcept;
std::array<std::uint8_t, kBitTimingBytes> bit_timing(const BitTiming& timing) noexcept;
/// Starts (or stops and resets) a channel with features in `flags`.
std::array<std::uint8_t, kModeBytes> mode(bool start, std::uint32_t flags) noexcept;
/// nullopt: shorter than it has to be.
std::optional<DeviceConfig> parse_device_config(std::span<const std::uint8_t> bytes) noexcept;
std::optional<Limits> parse_limits(std::span<const std::uint8_t> bytes) noexcept;
std::optional<ControllerState> parse_state(std::span<const std::uint8_t> bytes) noexcept;
std::optional<std::uint32_t> parse_timestamp(std::span<const std::uint8_t> bytes) noexcept;

/// A frame as the adapter sends it.
struct HostFrame {
  static constexpr std::uint32_t kReceived = 0xFFFFFFFF;
  std::uint32_t echo = kReceived;  ///< kReceived: from the bus; else the tag of a frame of ours that has gone
  std::uint8_t channel = 0;
  bool overflow = false;  ///< the adapter lost frames before this one
  std::optional<std::uint32_t> timestamp_us;
  image::CanFrame frame;
};

/// Writes a frame with the tag `echo`; how many bytes of `out` it takes. Classic frames only. real-time safe.
std::size_t encode(const image::CanFrame& frame, std::uint32_t echo, std::uint8_t channel,
                   std::uint32_t features, std::span<std::uint8_t, kStampedBytes> out) noexcept;
/// Takes a transfer apart. `stamped`: the channel was started with kHardwareTimestamp. False: too short, or a
/// length that no frame has. real-time safe.
bool decode(std::span<const std::uint8_t> bytes, bool stamped, HostFrame& out) noexcept;

/// The state that an error frame tells of, `before` when it tells of none. real-time safe.
image::CanState state_after(const image::CanFrame& error, image::CanState before) noexcept;
/// An error frame that says the controller takes part again. real-time safe.
image::CanFrame restarted() noexcept;

}  // namespace servogate::gsusb
