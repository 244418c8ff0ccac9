// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/modbus/link.hpp"

namespace servogate::modbus {

/// A frame on a serial line that says itself how long it is: station address, function, count of bytes,
/// bytes, checksum. libmodbus expects the lengths of the standard, which such answers do not have.
struct CountedFrame {
  std::array<std::uint8_t, 3 + 255 + 2> bytes{};
  std::size_t size = 0;
};

/// Reads one from a serial device that has begun to be readable. answer: whole, and its checksum is right.
/// Not real-time safe.
Heard read_counted_frame(int descriptor, image::Nanoseconds deadline, CountedFrame& frame);

}  // namespace servogate::modbus
