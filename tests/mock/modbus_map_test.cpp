// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "firmware_if/modbus/map.hpp"
#include "tests/property_seed.hpp"

namespace servogate::modbus {
namespace {

using image::Packets;
using image::parse_place;
using Kind = MapFault::Kind;

Point point(std::size_t block, std::uint16_t offset, const char* place) {
  Point p;
  p.block = block;
  p.offset = offset;
  p.rule.place = *parse_place(place);
  return p;
}

TEST(ModbusMap, reads_registers_of_every_word_order) {
  const Block block{1, Function::read_input_registers, 0, 4};
  Data data;
  data.words[0] = 0xFFFE;
  data.words[1] = 0x0001;
  const auto read = [&](WordType type) {
    Point p = point(0, 0, "SK10.LR");
    p.type = type;
    return raw_value(block, p, data);
  };
  EXPECT_EQ(read(WordType::u16), 65534.0);
  EXPECT_EQ(read(WordType::i16), -2.0);
  EXPECT_EQ(read(WordType::u32_hl), 4294836225.0);
  EXPECT_EQ(read(WordType::u32_lh), 131070.0);
  EXPECT_EQ(read(WordType::i32_hl), -131071.0);
  data.words[0] = 0x3FC0;  // 1.5f is 3FC00000h
  data.words[1] = 0x0000;
  EXPECT_EQ(read(WordType::f32_hl), 1.5);
}

TEST(ModbusMap, what_is_written_to_a_register_reads_back_as_near_as_its_type_allows) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> wide(-1e6, 1e6);
  constexpr WordType types[] = {WordType::i32_hl, WordType::i32_lh, WordType::f32_hl, WordType::f32_lh};
  const Block block{1, Function::write_multiple_registers, 0, 8};
  for (int i = 0; i < 20000; ++i) {
    Point p = point(0, static_cast<std::uint16_t>(random() % 7), "SK10.LR");
    p.type = types[random() % 4];
    const double v = wide(random);
    Data data;
    set_raw_value(block, p, v, data);
    const bool real = p.type == WordType::f32_hl || p.type == WordType::f32_lh;
    ASSERT_NEAR(raw_value(block, p, data), v, real ? std::abs(v) * 1e-7 + 1e-9 : 0.5001);
  }
}

TEST(ModbusMap, clamps_what_a_register_cannot_hold) {
  const Block block{1, Function::write_single_register, 0, 1};
  Point p = point(0, 0, "SK10.LR");
  Data data;
  set_raw_value(block, p, 1e9, data);
  EXPECT_EQ(data.words[0], 65535);
  set_raw_value(block, p, -5, data);
  EXPECT_EQ(data.words[0], 0);
  set_raw_value(block, p, std::nan(""), data);
  EXPECT_EQ(data.words[0], 0);
  p.type = WordType::i16;
  set_raw_value(block, p, -1e9, data);
  EXPECT_EQ(data.words[0], 0x8000);
}

TEST(ModbusMap, a_bit_of_a_register_leaves_its_neighbours_alone) {
  Map map{{{1, Function::write_multiple_registers, 0, 2}}, {point(0, 1, "SA8")}};
  map.points[0].bit = 5;
  ASSERT_TRUE(check(map, Packets{}).empty());
  Data data;
  data.words[1] = 0x8001;
  EXPECT_TRUE(set_raw_value(map.blocks[0], map.points[0], 1.0, data));
  EXPECT_EQ(data.words[1], 0x8021);
  EXPECT_EQ(data.words[0], 0);
  EXPECT_EQ(raw_value(map.blocks[0], map.points[0], data), 1.0);
  EXPECT_FALSE(set_raw_value(map.blocks[0], map.points[0], 1.0, data)) << "nothing has changed since";
}

TEST(ModbusMap, names_every_fault_of_a_map) {
  const auto only = [](const Map& map) {
    const auto faults = check(map, Packets{});
    EXPECT_EQ(faults.size(), 1u);
    return faults.empty() ? Kind::block_count : faults[0].kind;
  };
  const Block good{1, Function::read_discrete_inputs, 0, 16};
  Map map{{good}, {}};
  map.blocks[0].count = 0;
  EXPECT_EQ(only(map), Kind::block_count);
  map.blocks[0] = good;
  map.blocks[0].unit = 248;
  EXPECT_EQ(only(map), Kind::block_unit);
  map.blocks[0] = good;
  map.blocks[0].period_ns = 0;
  EXPECT_EQ(only(map), Kind::block_period);
  EXPECT_EQ(only({{good}, {point(1, 0, "SA0")}}), Kind::point_block);
  EXPECT_EQ(only({{good}, {point(0, 16, "SA0")}}), Kind::point_outside);
  EXPECT_EQ(only({{good}, {point(0, 0, "SK0.3CH")}}), Kind::point_place);
  EXPECT_EQ(only({{good}, {point(0, 0, "SK2000.BY")}}), Kind::point_place);
  EXPECT_EQ(only({{good}, {point(0, 0, "SA0"), point(0, 1, "SA0")}}), Kind::point_shared_place);
  Map bits{{good}, {point(0, 0, "SA0")}};
  bits.points[0].bit = 2;
  EXPECT_EQ(only(bits), Kind::point_bit);
  bits.points[0].bit = -1;
  bits.points[0].rule.scale = 0.0;
  EXPECT_EQ(only(bits), Kind::point_scale);
  Map wide{{{1, Function::read_input_registers, 0, 2}}, {point(0, 1, "SK0.LR")}};
  wide.points[0].type = WordType::u32_hl;
  EXPECT_EQ(only(wide), Kind::point_outside);
}

}  // namespace
}  // namespace servogate::modbus
