// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>

/// Hexadecimal text, upper case, without prefix or suffix. Not real-time safe.
namespace servogate::text {

/// At least so many digits: (0x2A, 4) is "002A".
inline std::string hex_number(std::uint64_t value, int digits) {
  std::string out;
  for (; value != 0; value >>= 4) out.insert(out.begin(), "0123456789ABCDEF"[value & 15]);
  if (out.size() < static_cast<std::size_t>(digits))
    out.insert(0, static_cast<std::size_t>(digits) - out.size(), '0');
  return out;
}

/// Two digits a byte, with `between` between two.
inline std::string hex_bytes(std::span<const std::uint8_t> bytes, const char* between = "") {
  std::string out;
  for (const std::uint8_t b : bytes) {
    if (!out.empty()) out += between;
    out += hex_number(b, 2);
  }
  return out;
}

}  // namespace servogate::text
