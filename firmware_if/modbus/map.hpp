// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware_if/image/points/point_stage.hpp"
#include "firmware_if/modbus/inverter.hpp"
#include "firmware_if/modbus/pdu.hpp"

namespace servogate::modbus {

/// A stretch of a station that is moved in one transaction, again and again.
struct Block {
  std::uint8_t unit = 1;  ///< station address 1-247
  Function function = Function::read_discrete_inputs;
  std::uint16_t address = 0;
  std::uint16_t count = 1;
  image::Nanoseconds period_ns = 20 * image::kMillisecond;
  Coding coding = Coding::standard;
};

/// How a number lies in the registers of a point; `_hl` = high word first, `_lh` = low word first.
enum class WordType : std::uint8_t { u16, i16, u32_hl, u32_lh, i32_hl, i32_lh, f32_hl, f32_lh };
constexpr std::uint16_t words_of(WordType t) noexcept { return t <= WordType::i16 ? 1 : 2; }

/// One point: where it lies in its block, and its rule. Whether it is an input and digital follows from its
/// block: reading blocks are inputs, bits digital.
struct Point {
  std::size_t block = 0;     ///< index into Map::blocks
  std::uint16_t offset = 0;  ///< bit or register from the block's address
  std::int8_t bit = -1;      ///< bit 0-15 inside a register; -1: the whole register(s)
  WordType type = WordType::u16;
  image::PointRule rule;
};

/// Registers and coils of one line as pure data.
struct Map {
  std::vector<Block> blocks;
  std::vector<Point> points;
  std::vector<Inverter> inverters = {};
};

/// What is wrong with a map; `index` = block or point.
struct MapFault {
  enum class Kind : std::uint8_t {
    block_count,         ///< 0, above the function's maximum, or past address 65535
    block_unit,          ///< not 1-247
    block_period,        ///< not positive
    point_block,         ///< no such block
    point_outside,       ///< reaches past the end of its block
    point_bit,           ///< bit above 15, or a bit of a coil
    point_place,         ///< outside its packet, or a character place
    point_scale,         ///< scale 0 or not finite
    point_shared_place,  ///< two reading points write overlapping places
  } kind;
  std::size_t index;
};
/// All faults of a map; empty: it may be used. Not real-time safe.
std::vector<MapFault> check(const Map& map, const image::Packets& packets);

/// A point as the data of its block have it; a bit: 0 or 1. real-time safe.
double raw_value(const Block& block, const Point& point, const Data& data) noexcept;
/// Puts a raw value into the data of its block; rounded to nearest and clamped to what the registers hold.
/// True: the data are not what they were. real-time safe.
bool set_raw_value(const Block& block, const Point& point, double raw, Data& data) noexcept;

}  // namespace servogate::modbus
