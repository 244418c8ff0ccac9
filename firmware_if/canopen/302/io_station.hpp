// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/image/points/point_stage.hpp"

namespace servogate::canopen {

/// One terminal of an I/O module, or a value of an encoder, as a point of packet A. Its object is in one of
/// the node's PDOs: a TPDO for an input, an RPDO for an output.
struct IoPoint {
  image::PointRule rule;  ///< digital: a bit of the object; otherwise the whole object, a number with sign
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::int8_t bit = -1;  ///< digital
};

/// What one node carries of the machine's points.
struct IoStation {
  std::vector<IoPoint> points;
  /// The module has 6206h, 6207h, 6443h and 6444h; false: where its outputs go without a master cannot be
  /// told.
  bool error_states = true;
};

}  // namespace servogate::canopen
