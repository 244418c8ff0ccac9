// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/coalesce.hpp"

#include <algorithm>

namespace servogate::modbus {

namespace {

std::uint32_t end_of(const Range& r) noexcept { return r.address + r.count; }

bool join(Range& into, const Range& other) noexcept {
  const bool touch = other.address <= end_of(into) && into.address <= end_of(other);
  if (into.function != other.function || writes(into.function) || !touch) return false;
  const std::uint32_t end = std::max(end_of(into), end_of(other));
  into.address = std::min(into.address, other.address);
  into.count = end - into.address;
  return true;
}

}  // namespace

std::vector<Block> coalesce(std::span<const Range> ranges, std::uint8_t unit, image::Nanoseconds period_ns) {
  std::vector<Range> joined;
  for (const Range& range : ranges) {
    if (range.count == 0) continue;
    Range whole = range;
    // What it joins may touch a third one now.
    for (auto other = joined.begin(); other != joined.end();) {
      if (!join(whole, *other)) {
        ++other;
        continue;
      }
      joined.erase(other);
      other = joined.begin();
    }
    joined.push_back(whole);
  }
  std::vector<Block> blocks;
  for (const Range& range : joined) {
    const std::uint32_t most = max_count(range.function);
    for (std::uint32_t at = 0; at < range.count; at += most)
      blocks.push_back({unit, range.function, static_cast<std::uint16_t>(range.address + at),
                        static_cast<std::uint16_t>(std::min(most, range.count - at)), period_ns});
  }
  return blocks;
}

std::optional<Spot> spot_of(std::span<const Block> blocks, Function function, std::uint32_t address) {
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    const Block& b = blocks[n];
    if (b.function == function && address >= b.address && address < std::uint32_t{b.address} + b.count)
      return Spot{n, static_cast<std::uint16_t>(address - b.address)};
  }
  return std::nullopt;
}

}  // namespace servogate::modbus
