// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/frame_record.hpp"

#include <algorithm>

namespace servogate::image {

namespace {

constexpr std::size_t kHalf = 4, kBytes = 2 * kHalf;
constexpr unsigned kRemote = 16, kExtended = 32;

double number_of(const std::uint8_t* bytes) noexcept {
  std::uint32_t number = 0;
  for (std::size_t i = kHalf; i-- > 0;) number = number << 8 | bytes[i];
  return number;
}

/// A number that came from a file may be anything.
std::uint32_t whole(double number) noexcept {
  return number >= 0.0 && number <= 4294967295.0 ? static_cast<std::uint32_t>(number) : 0;
}

void bytes_of(double number, std::uint8_t* bytes) noexcept {
  const std::uint32_t value = whole(number);
  for (std::size_t i = 0; i < kHalf; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace

void pack_frame(const CanFrame& frame, AlarmRecord& record) noexcept {
  record.value = frame.id;
  record.limit = number_of(frame.data.data());
  record.detail1 = number_of(frame.data.data() + kHalf);
  record.detail2 = static_cast<double>(std::min<std::size_t>(frame.length, kBytes) +
                                       (frame.remote ? kRemote : 0U) + (frame.extended ? kExtended : 0U));
}

CanFrame unpack_frame(const AlarmRecord& record) noexcept {
  CanFrame frame;
  const std::uint32_t kind = whole(record.detail2);
  frame.id = whole(record.value);
  frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(kind % kRemote, kBytes));
  frame.remote = (kind & kRemote) != 0;
  frame.extended = (kind & kExtended) != 0;
  if (frame.length == 0) return frame;
  bytes_of(record.limit, frame.data.data());
  bytes_of(record.detail1, frame.data.data() + kHalf);
  return frame;
}

}  // namespace servogate::image
