// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "firmware_if/image/frames/can_wire.hpp"
#include "firmware_if/image/frames/counted_frames.hpp"
#include "tests/property_seed.hpp"

namespace servogate::image {
namespace {

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> bytes, bool extended = false) {
  CanFrame f;
  f.id = id;
  f.extended = extended;
  f.length = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) f.data[i] = bytes[i];
  return f;
}

// The rule of ISO 11898-1 bit by bit, written a second time and as slowly as it reads.
struct Naive {
  std::vector<int> bits;
  void add(std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) bits.push_back(static_cast<int>(value >> i & 1));
  }
  explicit Naive(const CanFrame& f) {
    add(0, 1);
    if (f.extended) {
      add(f.id >> 18, 11);
      add(3, 2);
      add(f.id & 0x3FFFF, 18);
      add(f.remote, 1);
      add(0, 2);
    } else {
      add(f.id, 11);
      add(f.remote, 1);
      add(0, 2);
    }
    add(f.length, 4);
    for (int i = 0; i < (f.remote ? 0 : f.length); ++i) add(f.data[static_cast<std::size_t>(i)], 8);
    add(crc(), 15);
  }
  std::uint16_t crc() const {
    unsigned c = 0;
    for (const int b : bits) {
      const unsigned next = static_cast<unsigned>(b) ^ (c >> 14 & 1);
      c = c << 1 & 0x7FFF;
      if (next) c ^= 0x4599;
    }
    return static_cast<std::uint16_t>(c);
  }
  std::uint32_t stuffed() const {
    std::uint32_t count = 0;
    int last = -1, run = 0;
    for (const int b : bits) {
      run = b == last ? run + 1 : 1;
      last = b;
      if (run == 5) {
        ++count;
        last = 1 - b;
        run = 1;
      }
    }
    return count;
  }
};

TEST(FrameBits, all_zero_frames_get_a_stuff_bit_after_every_fifth_bit) {
  // Identifier 0, no data: 19 header bits and a CRC of zeros are 34 dominant bits; 34 / 5 = 6 stuff bits; 10
  // trailer.
  EXPECT_EQ(frame_crc(frame(0, {})), 0);
  EXPECT_EQ(stuff_bits(frame(0, {})), 6u);
  // ... but the DLC of an eight-byte frame is 1000b: zeros 15, one, then 3 + 64 zeros and a CRC.
  EXPECT_EQ(frame_bits(frame(0, {})), 34u + 6u + 10u);
}

TEST(FrameBits, known_frames_have_the_length_counted_on_paper) {
  struct Known {
    CanFrame frame;
    std::uint16_t crc;
    std::uint32_t stuffed, length;
  };
  const Known table[] = {
      // SYNC: 0 000 1 | 0000000 000 0000 | CRC 001110000000101: 16 zeros take three, seven zeros one.
      {frame(0x080, {}), 0x1C05, 4, 48},
      {frame(0x000, {1, 5}), 0x7CC1, 7, 67},
      {frame(0x705, {0x7F}), 0x576F, 3, 55},
      {frame(0x585, {0x43, 0, 0x10, 0, 0x92, 1, 2, 0}), 0x4D68, 7, 115},
      {frame(0x7FF, {255, 255, 255, 255, 255, 255, 255, 255}), 0x4C89, 15, 123},
      {frame(0x000, {0, 0, 0, 0, 0, 0, 0, 0}), 0x145B, 16, 124},
      {frame(0x555, {0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA}), 0x7DCE, 1, 109},
      {frame(0x18DAF110, {1, 2, 3}, true), 13801, 4, 92},
  };
  for (const Known& k : table) {
    EXPECT_EQ(frame_crc(k.frame), k.crc) << std::hex << k.frame.id;
    EXPECT_EQ(stuff_bits(k.frame), k.stuffed) << std::hex << k.frame.id;
    EXPECT_EQ(frame_bits(k.frame), k.length) << std::hex << k.frame.id;
  }
}

TEST(FrameBits, a_remote_frame_carries_its_length_code_but_no_data) {
  CanFrame f = frame(0x705, {0xFF});
  f.remote = true;
  EXPECT_EQ(frame_bits(f), 34u + Naive(f).stuffed() + kTrailerBits);
  EXPECT_EQ(Naive(f).bits.size(), 34u);
}

TEST(FrameBits, a_length_that_somebody_has_counted_is_taken_from_the_frame) {
  CanFrame f = frame(0x080, {});
  EXPECT_EQ(known_bits(f), frame_bits(f));
  f.wire_bits = 77;
  EXPECT_EQ(known_bits(f), 77u);
}

TEST(FrameBits, random_frames_agree_with_the_rule_bit_by_bit_and_stay_below_the_worst_case) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int i = 0; i < 20'000; ++i) {
    CanFrame f;
    f.extended = random() % 2;
    f.remote = random() % 8 == 0;
    f.id = random() & (f.extended ? 0x1FFFFFFF : 0x7FF);
    f.length = static_cast<std::uint8_t>(random() % 9);
    const int kind = static_cast<int>(random() % 3);  // noise, all zeros, all ones: the last two stuff most
    for (std::size_t n = 0; n < 8; ++n)
      f.data[n] = static_cast<std::uint8_t>(kind == 0 ? random() : kind == 1 ? 0 : 0xFF);
    if (random() % 4 == 0) f.id &= f.extended ? 0x10000 : 0x10;
    const Naive naive(f);
    ASSERT_EQ(stuff_bits(f), naive.stuffed());
    ASSERT_EQ(frame_bits(f), naive.bits.size() + naive.stuffed() + kTrailerBits);
    const std::uint32_t payload = f.remote ? 0u : f.length;
    ASSERT_LE(frame_bits(f) + kIntermissionBits, worst_case_bits(payload, f.extended));
  }
}

TEST(CountedFrames, frames_that_come_again_and_others_between_them_have_their_own_length) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  CountedFrames counted;
  for (int i = 0; i < 20'000; ++i) {
    // Few of each, so that they come again and push one another out.
    CanFrame f = frame(static_cast<std::uint32_t>(random() % 4 * 0x80 + random() % 3), {}, random() % 5 == 0);
    f.remote = random() % 5 == 0;
    f.length = static_cast<std::uint8_t>(random() % 2 * 8);
    f.data[random() % 8] = static_cast<std::uint8_t>(random() % 2 * 0xFF);
    ASSERT_EQ(counted.bits(f), frame_bits(f));
  }
}

TEST(CountedFrames, a_length_that_somebody_has_counted_is_taken_from_the_frame) {
  CanFrame f = frame(0x080, {});
  f.wire_bits = 77;
  EXPECT_EQ(CountedFrames().bits(f), 77u);
}

TEST(FrameBits, the_worst_case_of_the_formula_is_reached_by_some_frame) {
  // A run of five, then runs of four with the stuff bit as their first bit: 0000 0111 1000 0111 1 ... on the
  // wire. Search the payloads of repeated 0F/F0/87/78 patterns for the densest one.
  std::uint32_t densest = 0;
  for (const std::uint32_t id : {0x01Fu, 0x021u, 0x000u, 0x043u, 0x07Cu, 0x03Eu})
    for (const int pattern : {0x0F, 0xF0, 0x87, 0x78, 0xC3, 0x3C, 0xE1, 0x1E})
      densest = std::max(
          densest, stuff_bits(frame(id, std::vector<std::uint8_t>(8, static_cast<std::uint8_t>(pattern)))));
  EXPECT_GE(densest, 19u);
  EXPECT_LE(densest, (34u + 64u - 1u) / 4u);
}

}  // namespace
}  // namespace servogate::image
