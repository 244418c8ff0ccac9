// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/bus_meter.hpp"

#include <algorithm>

namespace servogate::canopen {
namespace {

// CRC delimiter, acknowledge slot and delimiter, end of frame (7), interframe space (3): never stuffed.
constexpr std::uint32_t kTrailerBits = 13;
constexpr unsigned kPolynomial = 0x4599;
constexpr unsigned kCrcMask = 0x7FFF;

// State of the stuffing: level of the last bit (bit 2) and length of its run minus one (bits 0-1). Five equal
// bits are followed at once by one of the other level, so no run of five is ever a state.
struct Stuffing {
  std::uint8_t state = 0;  // after the start of frame: level 0, run 1
  std::uint32_t inserted = 0;

  constexpr void bit(unsigned level) noexcept {
    const unsigned last = state >> 2, run = (state & 3u) + 1;
    if (level != last) {
      state = static_cast<std::uint8_t>(level << 2);
    } else if (run == 4) {
      ++inserted;
      state = static_cast<std::uint8_t>((level ^ 1u) << 2);
    } else {
      state = static_cast<std::uint8_t>(level << 2 | run);
    }
  }
};

// By state and byte: the state behind the byte in bits 0-2, the number of stuff bits above them.
constexpr auto kStuffTable = [] {
  std::array<std::array<std::uint8_t, 256>, 8> table{};
  for (unsigned state = 0; state < 8; ++state)
    for (unsigned byte = 0; byte < 256; ++byte) {
      Stuffing stuffing{static_cast<std::uint8_t>(state), 0};
      for (int i = 7; i >= 0; --i) stuffing.bit(byte >> i & 1u);
      table[state][byte] = static_cast<std::uint8_t>(stuffing.state | stuffing.inserted << 3);
    }
  return table;
}();

constexpr auto kCrcTable = [] {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte << 7;
    for (int i = 0; i < 8; ++i) crc = (crc << 1 ^ (crc & 0x4000 ? kPolynomial : 0u)) & kCrcMask;
    table[byte] = static_cast<std::uint16_t>(crc);
  }
  return table;
}();

class WireCounter {
 public:
  // The most significant bit goes first. Leading zero bits do not change the CRC.
  void bits(std::uint64_t value, unsigned count) noexcept {
    total_ += count;
    while (count % 8) {
      --count;
      const auto level = static_cast<unsigned>(value >> count & 1u);
      stuffing_.bit(level);
      crc_ = (crc_ << 1 ^ ((crc_ >> 14 ^ level) & 1u ? kPolynomial : 0u)) & kCrcMask;
    }
    while (count) {
      count -= 8;
      byte(static_cast<std::uint8_t>(value >> count));
    }
  }
  void byte(std::uint8_t value) noexcept {
    crc_ = (crc_ << 8 ^ kCrcTable[(crc_ >> 7 ^ value) & 0xFF]) & kCrcMask;
    const std::uint8_t step = kStuffTable[stuffing_.state][value];
    stuffing_.state = step & 7;
    stuffing_.inserted += step >> 3;
  }
  void data_byte(std::uint8_t value) noexcept {
    total_ += 8;
    byte(value);
  }
  std::uint32_t finish() noexcept {
    bits(crc_, 15);
    return total_ + stuffing_.inserted + kTrailerBits;
  }

 private:
  Stuffing stuffing_;
  unsigned crc_ = 0;
  std::uint32_t total_ = 1;  // start of frame, already in the stuffing's first state
};

}  // namespace

std::uint32_t wire_bits(const image::CanFrame& frame) noexcept {
  const unsigned length = std::min<unsigned>(frame.length, 8);
  const std::uint64_t remote = frame.remote ? 1 : 0;
  WireCounter counter;
  if (frame.extended) {
    // 11 bits of identifier, SRR and IDE recessive, 18 bits of identifier, RTR, two reserved bits, length.
    const std::uint64_t high = frame.id >> 18 & 0x7FF, low = frame.id & 0x3FFFF;
    counter.bits(((((high << 2 | 3) << 18 | low) << 1 | remote) << 2) << 4 | length, 38);
  } else {
    // 11 bits of identifier, RTR, IDE and a reserved bit dominant, length.
    counter.bits((((frame.id & 0x7FFull) << 1 | remote) << 2) << 4 | length, 18);
  }
  if (!frame.remote)
    for (unsigned i = 0; i < length; ++i) counter.data_byte(frame.data[i]);
  return counter.finish();
}

void BusMeter::close_cycle(image::Nanoseconds period_ns, std::uint32_t bit_rate) noexcept {
  const std::uint64_t bits = cycle_bits_;
  cycle_bits_ = 0;
  if (bit_rate == 0 || period_ns <= 0) return;
  const auto share = [bit_rate](std::uint64_t amount, image::Nanoseconds time) {
    return static_cast<double>(amount) * 1e9 / (static_cast<double>(bit_rate) * static_cast<double>(time));
  };
  worst_ = std::max(worst_, share(bits, period_ns));
  if (buckets_[bucket_].time_ns >= kBucketNs) {
    bucket_ = (bucket_ + 1) % kBuckets;
    sum_.bits -= buckets_[bucket_].bits;
    sum_.time_ns -= buckets_[bucket_].time_ns;
    buckets_[bucket_] = {};
  }
  for (Bucket* bucket : {&buckets_[bucket_], &sum_}) {
    bucket->bits += bits;
    bucket->time_ns += period_ns;
  }
  load_ = share(sum_.bits, sum_.time_ns);
}

}  // namespace servogate::canopen
