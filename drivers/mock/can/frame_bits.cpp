// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/can/frame_bits.hpp"

#include <algorithm>
#include <array>

namespace servogate::mock {
namespace {

constexpr std::uint32_t kCrcPolynomial = 0x4599;

constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte << 7;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 0x4000 ? (crc << 1) ^ kCrcPolynomial : crc << 1;
    table[byte] = static_cast<std::uint16_t>(crc & 0x7FFF);
  }
  return table;
}
constexpr auto kCrcTable = make_crc_table();

// State of the stuffing rule: bit 2 = last level, bits 0-1 = length of its run minus one (1-4; the fifth
// equal bit inserts its complement at once). A result carries the stuff bits inserted above bit 3.
constexpr std::uint8_t kStuffed = 8;
constexpr std::uint8_t stuff_one(std::uint8_t state, bool level) {
  const bool last = state & 4;
  const std::uint8_t run = state & 3;
  if (level != last) return static_cast<std::uint8_t>(level ? 4 : 0);
  if (run == 3) return static_cast<std::uint8_t>((level ? 0 : 4) | kStuffed);
  return static_cast<std::uint8_t>((level ? 4 : 0) | (run + 1));
}

constexpr std::array<std::array<std::uint8_t, 256>, 8> make_stuff_table() {
  std::array<std::array<std::uint8_t, 256>, 8> table{};
  for (std::uint8_t start = 0; start < 8; ++start) {
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      std::uint8_t state = start, count = 0;
      for (int bit = 7; bit >= 0; --bit) {
        const std::uint8_t next = stuff_one(state, byte >> bit & 1);
        count = static_cast<std::uint8_t>(count + (next & kStuffed));
        state = next & 7;
      }
      table[start][byte] = static_cast<std::uint8_t>(state | count);
    }
  }
  return table;
}
constexpr auto kStuffTable = make_stuff_table();

// Start of frame to data length code, right-aligned, first bit on the wire highest.
struct Header {
  std::uint64_t bits;
  int length;
};
Header header_of(const image::CanFrame& frame) noexcept {
  const std::uint64_t dlc = std::min<std::uint8_t>(frame.length, 8);
  const std::uint64_t rtr = frame.remote ? 1 : 0;
  if (!frame.extended) return {(frame.id & 0x7FFu) << 7 | rtr << 6 | dlc, 19};
  const std::uint64_t base = frame.id >> 18 & 0x7FFu, extension = frame.id & 0x3FFFFu;
  return {base << 27 | std::uint64_t{3} << 25 | extension << 7 | rtr << 6 | dlc, 39};
}

int payload_of(const image::CanFrame& frame) noexcept {
  return frame.remote ? 0 : std::min<int>(frame.length, 8);
}

std::uint16_t crc_of(const Header& header, const std::uint8_t* data, int bytes) noexcept {
  std::uint32_t crc = 0;
  const auto feed = [&crc](std::uint32_t byte) {
    crc = ((crc << 8) ^ kCrcTable[(crc >> 7 ^ byte) & 0xFF]) & 0x7FFF;
  };
  // Leading zero bits do not change a CRC that starts at zero, so the header is fed in whole bytes.
  for (int shift = header.length == 19 ? 16 : 32; shift >= 0; shift -= 8)
    feed(static_cast<std::uint32_t>(header.bits >> shift) & 0xFF);
  for (int i = 0; i < bytes; ++i) feed(data[i]);
  return static_cast<std::uint16_t>(crc);
}

class StuffCounter {
 public:
  void bits(std::uint64_t value, int count) noexcept {
    for (; count >= 8; count -= 8) byte(static_cast<std::uint8_t>(value >> (count - 8)));
    while (count-- > 0) take(stuff_one(state_, value >> count & 1));
  }
  void byte(std::uint8_t value) noexcept { take(kStuffTable[state_][value]); }
  std::uint32_t count() const noexcept { return count_; }

 private:
  void take(std::uint8_t result) noexcept {
    count_ += result / kStuffed;
    state_ = result & 7;
  }
  std::uint8_t state_ = 0;  // after the start of frame: one dominant bit
  std::uint32_t count_ = 0;
};

}  // namespace

std::uint16_t frame_crc(const image::CanFrame& frame) noexcept {
  return crc_of(header_of(frame), frame.data.data(), payload_of(frame));
}

std::uint32_t stuff_bits(const image::CanFrame& frame) noexcept {
  const Header header = header_of(frame);
  const int bytes = payload_of(frame);
  StuffCounter counter;
  counter.bits(header.bits, header.length - 1);
  for (int i = 0; i < bytes; ++i) counter.byte(frame.data[static_cast<std::size_t>(i)]);
  counter.bits(crc_of(header, frame.data.data(), bytes), 15);
  return counter.count();
}

std::uint32_t frame_bits(const image::CanFrame& frame) noexcept {
  const std::uint32_t header = frame.extended ? 39 : 19;
  return header + 8 * static_cast<std::uint32_t>(payload_of(frame)) + 15 + stuff_bits(frame) + kTrailerBits;
}

}  // namespace servogate::mock
