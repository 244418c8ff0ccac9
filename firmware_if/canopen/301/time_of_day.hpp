// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// TIME_OF_DAY: milliseconds after midnight and days since 1984-01-01. Source: CiA 301, 7.1.6.6.
struct TimeOfDay {
  std::uint32_t milliseconds = 0;  ///< 0-86'399'999
  std::uint16_t days = 0;
  bool operator==(const TimeOfDay&) const = default;

  static constexpr std::int64_t kDay = 86'400'000;  ///< ms
  /// So much later; the days wrap after 65535 as the type does. real-time safe.
  constexpr TimeOfDay after(image::Nanoseconds time) const noexcept {
    const std::int64_t ms = milliseconds + time / image::kMillisecond;
    return {static_cast<std::uint32_t>(ms % kDay), static_cast<std::uint16_t>(days + ms / kDay)};
  }
};

/// Message of the TIME producer on an identifier, by default that of the pre-defined connection set. Source:
/// CiA 301, 7.2.6. real-time safe.
inline image::CanFrame time_frame(const TimeOfDay& time, std::uint32_t id = cob::kTime) noexcept {
  std::array<std::uint8_t, 6> bytes{};
  store_le(time.milliseconds & 0x0FFF'FFFFu, std::span(bytes).first(4));
  store_le(time.days, std::span(bytes).subspan(4));
  return make_frame(id, bytes);
}
/// nullopt unless the frame has exactly 6 data bytes and a time that exists. real-time safe.
constexpr std::optional<TimeOfDay> parse_time(const image::CanFrame& frame) noexcept {
  if (frame.remote || frame.length != 6) return std::nullopt;
  const std::span<const std::uint8_t> bytes(frame.data);
  TimeOfDay time{static_cast<std::uint32_t>(load_le(bytes.first(4))) & 0x0FFF'FFFFu,
                 static_cast<std::uint16_t>(load_le(bytes.subspan(4, 2)))};
  if (time.milliseconds >= TimeOfDay::kDay) return std::nullopt;
  return time;
}

}  // namespace servogate::canopen
