// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::canopen {

/// What a CiA 402 device asks of its servo loops in one tick: where the shaft should be now, and how it goes
/// on until the next tick. Units: encoder counts, seconds, permille of the rated torque. A real drive's
/// firmware fills its loops with it; the simulator's plant does the same.
struct ServoCommand {
  enum class Loop : std::uint8_t {
    off,  ///< power stage without current: the motor coasts
    torque,
    velocity,  ///< velocity loop on `velocity`
    position,  ///< position loop on `position` with `velocity` and `acceleration` fed forward
  } loop = Loop::off;
  bool brake_released = false;
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double torque = 0.0;  ///< command of Loop::torque, added to the other loops' output
  double torque_limit_positive = 1000.0;
  double torque_limit_negative = 1000.0;  ///< a magnitude
};

/// What the servo measures in one tick.
struct ServoState {
  std::int64_t position = 0;            ///< encoder counts
  double velocity = 0.0;                ///< counts/s
  double torque = 0.0;                  ///< permille of rated torque
  bool saturated = false;               ///< the torque limit was reached
  bool zero_mark = false;               ///< the zero mark was passed in this tick ...
  std::int64_t zero_mark_position = 0;  ///< ... here, exact
};

}  // namespace servogate::canopen
