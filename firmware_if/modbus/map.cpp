// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace servogate::modbus {

namespace {

constexpr bool high_word_first(WordType t) noexcept {
  return t == WordType::u32_hl || t == WordType::i32_hl || t == WordType::f32_hl;
}

double number_of(WordType type, std::uint16_t first, std::uint16_t second) noexcept {
  const std::uint32_t high = high_word_first(type) ? first : second;
  const std::uint32_t both = high << 16 | (high_word_first(type) ? second : first);
  switch (type) {
    case WordType::u16:
      return first;
    case WordType::i16:
      return static_cast<std::int16_t>(first);
    case WordType::u32_hl:
    case WordType::u32_lh:
      return both;
    case WordType::i32_hl:
    case WordType::i32_lh:
      return static_cast<std::int32_t>(both);
    case WordType::f32_hl:
    case WordType::f32_lh:
      return std::bit_cast<float>(both);
  }
  return 0.0;
}

/// Nearest integer inside [low, high]; not a number gives 0.
std::int64_t clamped(double v, double low, double high) noexcept {
  return std::isnan(v) ? 0 : static_cast<std::int64_t>(std::nearbyint(std::clamp(v, low, high)));
}

std::uint32_t raw_bits(WordType type, double v) noexcept {
  switch (type) {
    case WordType::u16:
      return static_cast<std::uint32_t>(clamped(v, 0, 65535));
    case WordType::i16:
      return static_cast<std::uint16_t>(clamped(v, -32768, 32767));
    case WordType::u32_hl:
    case WordType::u32_lh:
      return static_cast<std::uint32_t>(clamped(v, 0, 4294967295.0));
    case WordType::i32_hl:
    case WordType::i32_lh:
      return static_cast<std::uint32_t>(clamped(v, -2147483648.0, 2147483647.0));
    case WordType::f32_hl:
    case WordType::f32_lh:
      return std::bit_cast<std::uint32_t>(static_cast<float>(v));
  }
  return 0;
}

std::uint32_t reach(const Block& block, const Point& p) noexcept {
  const bool whole = !carries_bits(block.function) && p.bit < 0;
  return p.offset + (whole ? words_of(p.type) : 1u);
}

void check_block(const Block& b, std::size_t n, std::vector<MapFault>& out) {
  if (b.count < 1 || b.count > max_count(b.function) || std::uint32_t{b.address} + b.count > 0x10000u)
    out.push_back({MapFault::Kind::block_count, n});
  if (b.unit < 1 || b.unit > 247) out.push_back({MapFault::Kind::block_unit, n});
  if (b.period_ns <= 0) out.push_back({MapFault::Kind::block_period, n});
}

void check_point(const Map& map, std::size_t n, const image::Packets& packets, std::vector<MapFault>& out) {
  const Point& p = map.points[n];
  if (p.block >= map.blocks.size()) {
    out.push_back({MapFault::Kind::point_block, n});
    return;
  }
  const Block& block = map.blocks[p.block];
  if (reach(block, p) > block.count) out.push_back({MapFault::Kind::point_outside, n});
  if (p.bit > 15 || (p.bit >= 0 && carries_bits(block.function)))
    out.push_back({MapFault::Kind::point_bit, n});
  if (p.rule.place.format == image::Format::ch || !packets.contains(p.rule.place))
    out.push_back({MapFault::Kind::point_place, n});
  if (p.rule.scale == 0.0 || !std::isfinite(p.rule.scale) || !std::isfinite(p.rule.shift))
    out.push_back({MapFault::Kind::point_scale, n});
  for (std::size_t other = 0; other < n && !writes(block.function); ++other) {
    const Point& o = map.points[other];
    if (o.block < map.blocks.size() && !writes(map.blocks[o.block].function) &&
        o.rule.place.overlaps(p.rule.place))
      out.push_back({MapFault::Kind::point_shared_place, n});
  }
}

}  // namespace

std::vector<MapFault> check(const Map& map, const image::Packets& packets) {
  std::vector<MapFault> out;
  for (std::size_t n = 0; n < map.blocks.size(); ++n) check_block(map.blocks[n], n, out);
  for (std::size_t n = 0; n < map.points.size(); ++n) check_point(map, n, packets, out);
  return out;
}

double raw_value(const Block& block, const Point& p, const Data& data) noexcept {
  if (carries_bits(block.function)) return data.bit(p.offset) ? 1.0 : 0.0;
  const std::uint16_t first = data.words[p.offset];
  if (p.bit >= 0) return (first >> p.bit & 1) != 0 ? 1.0 : 0.0;
  return number_of(p.type, first, words_of(p.type) == 2 ? data.words[p.offset + 1u] : std::uint16_t{0});
}

bool set_raw_value(const Block& block, const Point& p, double raw, Data& data) noexcept {
  const bool on = raw != 0.0;
  if (carries_bits(block.function)) {
    const bool was = data.bit(p.offset);
    data.set_bit(p.offset, on);
    return on != was;
  }
  const std::size_t last = p.offset + words_of(p.type) - 1u;
  std::uint16_t& first = data.words[p.offset];
  const std::uint16_t was[] = {first, data.words[last]};
  if (p.bit >= 0) {
    const auto mask = static_cast<std::uint16_t>(1u << p.bit);
    first = static_cast<std::uint16_t>(on ? first | mask : first & ~mask);
  } else if (const std::uint32_t bits = raw_bits(p.type, raw); words_of(p.type) == 1) {
    first = static_cast<std::uint16_t>(bits);
  } else {
    const auto high = static_cast<std::uint16_t>(bits >> 16), low = static_cast<std::uint16_t>(bits);
    first = high_word_first(p.type) ? high : low;
    data.words[last] = high_word_first(p.type) ? low : high;
  }
  return first != was[0] || data.words[last] != was[1];
}

}  // namespace servogate::modbus
