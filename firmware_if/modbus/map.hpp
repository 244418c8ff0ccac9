// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/time.hpp"
#include "firmware_if/modbus/pdu.hpp"

namespace servogate::modbus {

/// A stretch of a station that is moved in one transaction, again and again.
struct Block {
  std::uint8_t unit = 1;  ///< station address 1-247
  Function function = Function::read_discrete_inputs;
  std::uint16_t address = 0;
  std::uint16_t count = 1;
  image::Nanoseconds period_ns = 20 * image::kMillisecond;
};

/// How a number lies in the registers of a point; `_hl` = high word first, `_lh` = low word first.
enum class WordType : std::uint8_t { u16, i16, u32_hl, u32_lh, i32_hl, i32_lh, f32_hl, f32_lh };
constexpr std::uint16_t words_of(WordType t) noexcept { return t <= WordType::i16 ? 1 : 2; }

/// What a place of the packet gets when its station is lost.
enum class OnLoss : std::uint8_t { hold, value };

/// One point: where it lies in its block, and its place in packet A or K. Reading blocks write the place,
/// writing blocks read it.
struct Point {
  std::size_t block = 0;     ///< index into Map::blocks
  std::uint16_t offset = 0;  ///< bit or register from the block's address
  std::int8_t bit = -1;      ///< bit 0-15 inside a register; -1: the whole register(s)
  WordType type = WordType::u16;
  image::Place place;
  bool inverted = false;  ///< bits only
  double scale = 1.0;     ///< place = raw * scale + shift
  double shift = 0.0;
  OnLoss on_loss = OnLoss::hold;
  double loss_value = 0.0;  ///< in the units of the place
};

/// Registers and coils of one bus as pure data.
struct Map {
  std::vector<Block> blocks;
  std::vector<Point> points;
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

/// Value of a point in the data of its block, in the units of the place. real-time safe.
double value(const Block& block, const Point& point, const Data& data) noexcept;
/// Puts a value (units of the place) into the data of its block; rounded to nearest and clamped to what the
/// registers hold. real-time safe.
void set_value(const Block& block, const Point& point, double v, Data& data) noexcept;

/// Data of a reading block into the places of its points. real-time safe (all points are looked at).
void scatter(const Map& map, std::size_t block, const Data& data, image::Packets& packets) noexcept;
/// Places of a writing block's points into its data; registers without a point keep their content. True: the
/// data are not what they were. real-time safe.
bool gather(const Map& map, std::size_t block, const image::Packets& packets, Data& data) noexcept;
/// Loss values of a reading block's points into their places. real-time safe.
void apply_loss(const Map& map, std::size_t block, image::Packets& packets) noexcept;

}  // namespace servogate::modbus
