// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "firmware_if/pendant/layout.hpp"

namespace servogate::pendant {

/// What a pendant shows. Axes by their index in Layout::axes; mm or degrees.
struct Shown {
  std::array<double, kMostAxes> work{}, machine{};
  double feed_mm_min = 0.0, spindle_rpm = 0.0;
  double feed_override = 100.0, spindle_override = 100.0;  ///< per cent
  int selected = -1;                                       ///< axis, -1: none
  int step = -1;                                           ///< index in Layout::steps, -1: none
  bool machine_coordinates = false;                        ///< in the fields `shown`
  bool reset = false;                                      ///< an alarm stands
  friend bool operator==(const Shown&, const Shown&) = default;
};

/// The feature reports that show it, each with its number in front; empty: the pendant has no display. A row
/// is that of the selected axis' three: behind X, Y, Z come A, B, C. Whole number and ten-thousandths are two
/// bytes each, low byte first, the sign in the last bit of the second. Not real-time safe.
std::vector<std::vector<std::uint8_t>> show(const Layout& layout, const Shown& shown);

}  // namespace servogate::pendant
