// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace servogate::report {

/// Numbers in little room: multiples of `quantum`, differences of the given order, seven bits a byte,
/// deflated.
struct Column {
  std::size_t count = 0;
  double quantum = 1.0;
  int order = 1;
  std::string bytes;  ///< RFC 1951
};

/// Packs values to the nearest multiple of `quantum` (> 0). Where a value would need more than 48 bits the
/// quantum is doubled until none does, so that a reader may count in double. What is not finite becomes 0.
/// `order` 0 to 3: how often neighbours are subtracted first; a smooth curve grows smaller with each.
Column pack(std::span<const double> values, double quantum, int order);

/// Deflated bytes (RFC 1951, without a header).
std::string deflated(std::string_view bytes);

}  // namespace servogate::report
