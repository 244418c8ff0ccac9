// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/image/time.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

/// Bits of the error register 1001h. Source: CiA 301, 7.5.2.2.
namespace error_register {
inline constexpr std::uint8_t kGeneric = 0x01, kCurrent = 0x02, kVoltage = 0x04, kTemperature = 0x08,
                              kCommunication = 0x10, kDeviceProfile = 0x20, kManufacturer = 0x80;
}

/// The data of SYNC are not as 1019h has them. Source: CiA 301, 7.2.7.1, table 26.
inline constexpr std::uint16_t kUnexpectedSyncLength = 0x8240;

/// One emergency message. error_code 0 = "error reset or no error". Source: CiA 301, 7.2.7.
struct Emcy {
  std::uint16_t error_code = 0;
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> manufacturer{};
  bool operator==(const Emcy&) const = default;
};

/// real-time safe.
inline image::CanFrame emcy_frame(NodeId node, const Emcy& emcy) noexcept {
  std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(emcy.error_code & 0xFF),
                                    static_cast<std::uint8_t>(emcy.error_code >> 8), emcy.error_register};
  for (std::size_t i = 0; i < 5; ++i) bytes[3 + i] = emcy.manufacturer[i];
  return make_frame(cob::emcy(node), bytes);
}
/// nullopt unless the frame has exactly 8 data bytes. real-time safe.
constexpr std::optional<Emcy> parse_emcy(const image::CanFrame& frame) noexcept {
  if (frame.remote || frame.length != 8) return std::nullopt;
  Emcy emcy;
  emcy.error_code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
  emcy.error_register = frame.data[2];
  for (std::size_t i = 0; i < 5; ++i) emcy.manufacturer[i] = frame.data[3 + i];
  return emcy;
}

/// Words for an EMCY or 603Fh error code: the exact code of CiA 402-1 / CiA 301 where it is known, otherwise
/// that of its group (xx00h, x000h). Never null. real-time safe.
const text::Entry& error_code_text(std::uint16_t error_code) noexcept;

/// The last emergency messages of a node, newest first, as its own 1003h keeps them. All members are
/// real-time safe.
class EmcyHistory {
 public:
  static constexpr std::size_t kSize = 8;
  struct Item {
    Emcy emcy;
    image::Nanoseconds t_ns = 0;
  };

  void add(const Emcy& emcy, image::Nanoseconds t_ns) noexcept {
    newest_ = (newest_ + kSize - 1) % kSize;
    items_[newest_] = {emcy, t_ns};
    ++count_;
  }
  /// Messages since the start.
  std::uint32_t count() const noexcept { return count_; }
  /// Kept messages.
  std::size_t size() const noexcept { return count_ < kSize ? count_ : kSize; }
  /// i-th newest, i < size().
  const Item& operator[](std::size_t i) const noexcept { return items_[(newest_ + i) % kSize]; }

 private:
  std::array<Item, kSize> items_{};
  std::size_t newest_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace servogate::canopen
