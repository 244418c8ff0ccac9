// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/time.hpp"

namespace servogate::image {

/// Something that evolves with time beside the control: simulated devices on mock buses. Called by whoever
/// owns the loop before each cycle; never by the cycle itself.
class Simulated {
 public:
  virtual ~Simulated() = default;
  /// Brings the simulation to time t (never backwards).
  virtual void advance_to(Nanoseconds t) = 0;
};

}  // namespace servogate::image
