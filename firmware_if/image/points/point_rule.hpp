// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::image {

/// One point of a station as the machine file declares it, whatever carries it.
struct PointRule {
  Place place;
  bool input = true;
  bool digital = true;
  bool inverted = false;  ///< digital: the wire's 1 is 0 in the packet
  bool hold = false;      ///< keeps its value while its source is lost, instead of `loss`
  double loss = 0.0;      ///< in the packet for an input, on the wire for an output
  double scale = 1.0;     ///< not 0; analog: value in the packet = raw * scale + shift
  double shift = 0.0;
  Nanoseconds debounce_ns = 0;  ///< digital input: a change is shown after it has lasted so long
  double hysteresis = 0.0;      ///< analog input: a smaller change than this is not shown, units of the place
  std::uint16_t group = 0;      ///< of the points that are read together and age together
};

/// What a value in the packet is on the wire; digital: 0 or 1, analog: neither rounded nor limited.
/// real-time safe.
inline double raw_of(const PointRule& rule, double value) noexcept {
  if (rule.digital) return (value != 0.0) != rule.inverted ? 1.0 : 0.0;
  return (value - rule.shift) / rule.scale;
}
/// The inverse. real-time safe.
inline double value_of(const PointRule& rule, double raw) noexcept {
  if (rule.digital) return (raw != 0.0) != rule.inverted ? 1.0 : 0.0;
  return raw * rule.scale + rule.shift;
}

}  // namespace servogate::image
