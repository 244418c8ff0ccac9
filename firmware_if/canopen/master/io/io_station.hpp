// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/image/packets.hpp"

namespace servogate::canopen {

/// One terminal of an I/O module, or a value of an encoder, with its place in packet A. Its object is in one
/// of the node's PDOs: a TPDO for an input, an RPDO for an output.
struct IoPoint {
  bool input = true;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::int8_t bit = -1;  ///< of the object; -1: the whole object is a number with sign
  image::Place place;
  bool inverted = false;  ///< digital: the wire's 1 is 0 in packet A
  bool hold = false;      ///< keeps its last value while the node is lost, instead of `loss`
  double loss = 0.0;      ///< in packet A for an input, on the wire for an output
  double scale = 1.0;     ///< not 0; analogue: value in packet A = raw * scale + shift
  double shift = 0.0;
};

/// What one node carries of the machine's points.
struct IoStation {
  std::vector<IoPoint> points;
};

}  // namespace servogate::canopen
