// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware_if/modbus/map.hpp"

namespace servogate::modbus {

/// Items of a unit that are wanted: bits or registers, by function.
struct Range {
  Function function = Function::read_discrete_inputs;
  std::uint16_t address = 0;
  std::uint32_t count = 0;
};

/// The blocks that carry these ranges of one unit in the fewest transactions: ranges of one reading function
/// that touch or overlap become one, and none is longer than the protocol permits. In the order in which the
/// functions and places were named. Not real-time safe.
std::vector<Block> coalesce(std::span<const Range> ranges, std::uint8_t unit, image::Nanoseconds period_ns);

/// nullopt: no block carries it. Not real-time safe.
std::optional<Spot> spot_of(std::span<const Block> blocks, Function function, std::uint32_t address);

}  // namespace servogate::modbus
