// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/frames/can_wire.hpp"

#include <algorithm>
#include <array>

namespace servogate::image {
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

// What a byte adds to the CRC when so many others follow it: a CRC is linear, so that each counts by itself.
constexpr std::size_t kMostBytes = 8;
constexpr auto make_data_tables() {
  std::array<std::array<std::uint16_t, 256>, kMostBytes> tables{};
  tables[0] = kCrcTable;
  for (std::size_t n = 1; n < tables.size(); ++n)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t crc = tables[n - 1][byte];
      tables[n][byte] = static_cast<std::uint16_t>((crc << 8 & 0x7FFF) ^ kCrcTable[crc >> 7]);
    }
  return tables;
}
constexpr auto kDataTables = make_data_tables();

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

// By state and the next so many bits: the state behind them in the low byte, the stuff bits that they took
// in the high one. The sum of a frame's steps has its stuff bits above the sum of its states.
constexpr int kCountShift = 8;
template <int Bits>
constexpr auto make_stuff_table() {
  std::array<std::array<std::uint16_t, 1 << Bits>, 8> table{};
  for (std::uint8_t start = 0; start < 8; ++start) {
    for (std::uint32_t value = 0; value < 1u << Bits; ++value) {
      std::uint8_t state = start, count = 0;
      for (int bit = Bits - 1; bit >= 0; --bit) {
        const std::uint8_t next = stuff_one(state, value >> bit & 1);
        count = static_cast<std::uint8_t>(count + next / kStuffed);
        state = next & 7;
      }
      table[start][value] = static_cast<std::uint16_t>(state | count << kCountShift);
    }
  }
  return table;
}
template <int Bits>
constexpr auto kStuffTable = make_stuff_table<Bits>();

// Start of frame to data length code, right-aligned, first bit on the wire highest.
constexpr int kBaseHeader = 19, kExtendedHeader = 39;
std::uint64_t header_of(const CanFrame& frame) noexcept {
  const std::uint64_t dlc = std::min<std::uint8_t>(frame.length, 8);
  const std::uint64_t rtr = frame.remote ? 1 : 0;
  if (!frame.extended) return (frame.id & 0x7FFu) << 7 | rtr << 6 | dlc;
  const std::uint64_t base = frame.id >> 18 & 0x7FFu, extension = frame.id & 0x3FFFFu;
  return base << 27 | std::uint64_t{3} << 25 | extension << 7 | rtr << 6 | dlc;
}

unsigned payload_of(const CanFrame& frame) noexcept {
  return frame.remote ? 0 : std::min<unsigned>(frame.length, 8);
}

// CRC and stuff bits of a frame, a table step each for up to eight bits: the cycle counts every frame.
class WireCounter {
 public:
  explicit WireCounter(const CanFrame& frame) noexcept {
    const std::uint64_t header = header_of(frame);
    // Leading zero bits do not change a CRC that starts at zero, so the header is fed to it in whole bytes.
    if (frame.extended) {
      for (int shift = 32; shift > 16; shift -= 8) feed(header >> shift & 0xFF);
      take<4>(header >> 34);
      take<4>(header >> 30 & 0xF);
      take<8>(header >> 22 & 0xFF);
      take<8>(header >> 14 & 0xFF);
    } else {
      take<4>(header >> 14);
    }
    for (int shift = 16; shift >= 0; shift -= 8) feed(header >> shift & 0xFF);
    take<7>(header >> 7 & 0x7F);
    take<7>(header & 0x7F);
    take_data(frame, payload_of(frame));
  }
  std::uint16_t crc() const noexcept { return static_cast<std::uint16_t>(crc_ & 0x7FFF); }
  /// Those of the CRC included; once.
  std::uint32_t stuffed() noexcept {
    take<8>(crc_ >> 7 & 0xFF);
    take<7>(crc_ & 0x7F);
    return steps_ >> kCountShift;
  }

 private:
  void take_data(const CanFrame& frame, unsigned bytes) noexcept {
    if (bytes < 2) {
      if (bytes == 0) return;
      feed(frame.data[0]);
      return take<8>(frame.data[0]);
    }
    // The fifteen bits of the header's CRC reach into the first two bytes.
    const auto* after = &kDataTables[bytes - 1];
    std::uint32_t crc = (*after--)[(crc_ >> 7 ^ frame.data[0]) & 0xFF];
    crc ^= (*after--)[(crc_ << 1 & 0xFE) ^ frame.data[1]];
    take<8>(frame.data[0]);
    take<8>(frame.data[1]);
    for (unsigned i = 2; i < bytes; ++i) {
      crc ^= (*after--)[frame.data[i]];
      take<8>(frame.data[i]);
    }
    crc_ = crc;
  }
  void feed(std::uint64_t byte) noexcept { crc_ = (crc_ << 8) ^ kCrcTable[(crc_ >> 7 ^ byte) & 0xFF]; }
  template <int Bits>
  void take(std::uint64_t value) noexcept {
    const std::uint32_t result = kStuffTable<Bits>[state_][value];
    steps_ += result;
    state_ = result & 7;
  }
  std::uint32_t crc_ = 0;    ///< in its lower 15 bits
  std::uint32_t state_ = 0;  // after the start of frame: one dominant bit
  std::uint32_t steps_ = 0;
};

}  // namespace

std::uint16_t frame_crc(const CanFrame& frame) noexcept { return WireCounter(frame).crc(); }

std::uint32_t stuff_bits(const CanFrame& frame) noexcept { return WireCounter(frame).stuffed(); }

std::uint32_t frame_bits(const CanFrame& frame) noexcept {
  const std::uint32_t header = frame.extended ? kExtendedHeader : kBaseHeader;
  return header + 8 * payload_of(frame) + 15 + stuff_bits(frame) + kTrailerBits;
}

}  // namespace servogate::image
