// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware_if/modbus/map.hpp"

namespace servogate::modbus {

/// What a station is taken to need from the last byte of a request to the first one of its answer.
inline constexpr image::Nanoseconds kAnswerDelay = 2 * image::kMillisecond;
/// Age from which the data of a block count as stale, in periods of the block; as bad after twice that.
inline constexpr int kStaleAfterPeriods = 3;

/// Times of a serial line: characters of 11 bits, and 3.5 of them as the silence behind each frame, fixed
/// above 19200 baud. Source: Modbus over Serial Line V1.02, section 2.5.1.1. real-time safe.
class LineTime {
 public:
  /// 0: no line time (TCP).
  constexpr explicit LineTime(std::uint32_t baud) noexcept : baud_(baud) {}
  image::Nanoseconds characters(std::size_t count) const noexcept;
  image::Nanoseconds silence() const noexcept;
  /// Of the request for a block, with station address and checksum.
  image::Nanoseconds request(const Block& block) const noexcept;
  /// Of one transaction without a fault, with the silence behind it.
  image::Nanoseconds transaction(const Block& block, image::Nanoseconds answer_delay) const noexcept;

 private:
  std::uint32_t baud_;
};

}  // namespace servogate::modbus
