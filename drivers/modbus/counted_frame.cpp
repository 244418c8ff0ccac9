// SPDX-License-Identifier: Apache-2.0
#include "drivers/modbus/counted_frame.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "drivers/clock.hpp"

namespace servogate::modbus {

namespace {

constexpr std::size_t kHead = 3, kChecksum = 2;
constexpr std::uint8_t kExceptionFlag = 0x80;

/// Modbus over Serial Line V1.02, 6.2.2; that of a frame with its checksum is 0.
std::uint16_t checksum(const std::uint8_t* bytes, std::size_t size) noexcept {
  unsigned crc = 0xFFFF;
  for (std::size_t n = 0; n < size; ++n) {
    crc ^= bytes[n];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? (crc >> 1) ^ 0xA001u : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

/// Behind an exception there is its code instead of a count.
std::size_t length_of(const CountedFrame& f) noexcept {
  const bool exception = (f.bytes[1] & kExceptionFlag) != 0;
  return kHead + (exception ? 0u : f.bytes[2]) + kChecksum;
}

}  // namespace

Heard read_counted_frame(int descriptor, image::Nanoseconds deadline, CountedFrame& f) {
  f.size = 0;
  std::size_t wanted = kHead;
  while (f.size < wanted) {
    const image::Nanoseconds left =
        std::max<image::Nanoseconds>(0, deadline - drivers::clock_ns(CLOCK_MONOTONIC));
    const timespec patience{static_cast<time_t>(left / image::kSecond),
                            static_cast<long>(left % image::kSecond)};
    pollfd readable{descriptor, POLLIN, 0};
    const int ready = ppoll(&readable, 1, &patience, nullptr);
    if (ready == 0) return f.size == 0 ? Heard::silence : Heard::half;
    const ssize_t got = ready < 0 ? -1 : ::read(descriptor, f.bytes.data() + f.size, wanted - f.size);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) return Heard::broken;
    f.size += static_cast<std::size_t>(got);
    if (f.size >= kHead) wanted = length_of(f);
  }
  return checksum(f.bytes.data(), f.size) == 0 ? Heard::answer : Heard::malformed;
}

}  // namespace servogate::modbus
