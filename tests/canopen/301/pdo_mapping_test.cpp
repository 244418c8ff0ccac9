// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/pdo_mapping.hpp"

#include <gtest/gtest.h>

#include <random>

namespace servogate::canopen {
namespace {

TEST(MappingEntry, is_the_32_bit_word_of_the_mapping_parameter) {
  const MappingEntry position{0x607A, 0, 32};
  EXPECT_EQ(position.word(), 0x607A0020u);
  EXPECT_EQ(MappingEntry::from_word(0x60FE0120), (MappingEntry{0x60FE, 1, 32}));
  EXPECT_TRUE(MappingEntry::from_word(0x00050008).dummy());
  EXPECT_FALSE(position.dummy());
}

TEST(PdoMapping, takes_no_more_than_64_bits) {
  PdoMapping map;
  EXPECT_TRUE(map.add({0x6040, 0, 16}));
  EXPECT_TRUE(map.add({0x607A, 0, 32}));
  EXPECT_TRUE(map.add({0x6060, 0, 8}));
  EXPECT_EQ(map.bytes(), 7);
  EXPECT_FALSE(map.add({0x60B8, 0, 16}));
  EXPECT_EQ(map.count, 3);
  EXPECT_TRUE(map.add({0x0005, 0, 8}));
  EXPECT_EQ(map.bytes(), 8);
}

TEST(PdoMapping, lays_values_out_little_endian_one_after_another) {
  PdoMapping map;
  map.add({0x6040, 0, 16});
  map.add({0x607A, 0, 32});
  std::array<std::uint8_t, 8> bytes{};
  const std::array<std::uint64_t, 2> values{0x000F, static_cast<std::uint32_t>(-2)};
  EXPECT_EQ(pack(map, values, bytes), 6);
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 8>{0x0F, 0x00, 0xFE, 0xFF, 0xFF, 0xFF, 0, 0}));
  std::array<std::uint64_t, 2> back{};
  ASSERT_TRUE(unpack(map, std::span(bytes).first(6), back));
  EXPECT_EQ(sign_extend(back[1], 32), -2);
}

TEST(PdoMapping, a_short_frame_is_refused_and_a_long_one_is_cut) {
  PdoMapping map;
  map.add({0x6041, 0, 16});
  std::array<std::uint64_t, 1> value{77};
  const std::array<std::uint8_t, 3> bytes{0x37, 0x02, 0xFF};
  EXPECT_FALSE(unpack(map, std::span(bytes).first(1), value));
  EXPECT_EQ(value[0], 77u);
  EXPECT_TRUE(unpack(map, bytes, value));
  EXPECT_EQ(value[0], 0x0237u);
}

TEST(PdoMapping, any_random_map_of_any_bits_gives_back_what_was_put_in) {
  constexpr unsigned kSeed = 7;
  std::mt19937_64 random(kSeed);
  for (int i = 0; i < 20'000; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    PdoMapping map;
    std::array<std::uint64_t, kMaxMappedObjects> values{}, back{};
    while (map.add({0x2000, 0, static_cast<std::uint8_t>(1 + random() % 40)})) {
      const std::uint32_t bits = map.entries[map.count - 1].bits;
      values[map.count - 1] = random() & ((std::uint64_t{1} << bits) - 1);
    }
    std::array<std::uint8_t, 8> bytes;
    bytes.fill(static_cast<std::uint8_t>(random()));
    ASSERT_EQ(pack(map, values, bytes), map.bytes());
    ASSERT_TRUE(unpack(map, std::span(bytes).first(map.bytes()), back));
    ASSERT_EQ(values, back);
  }
}

TEST(Bits, beyond_the_end_of_the_data_nothing_is_read_or_written) {
  std::array<std::uint8_t, 2> bytes{0xFF, 0xFF};
  EXPECT_EQ(extract_bits(bytes, 12, 16), 0x0Fu);
  EXPECT_EQ(extract_bits(bytes, 64, 8), 0u);
  insert_bits(bytes, 12, 16, 0);
  EXPECT_EQ(bytes[1], 0x0F);
}

TEST(Bits, sign_extension_keeps_the_number) {
  EXPECT_EQ(sign_extend(0x80, 8), -128);
  EXPECT_EQ(sign_extend(0x7F, 8), 127);
  EXPECT_EQ(sign_extend(0xFFFF'FFFF, 32), -1);
  EXPECT_EQ(sign_extend(0xFFFF'FFFF'FFFF'FFFF, 64), -1);
  EXPECT_EQ(sign_extend(1, 1), -1);
}

}  // namespace
}  // namespace servogate::canopen
