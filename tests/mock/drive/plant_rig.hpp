// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "drivers/mock/drive/plant.hpp"

namespace servogate::mock {

using canopen::ServoCommand;
constexpr image::Nanoseconds kStep = 250'000;
constexpr double kStepS = 250e-6;

/// Commands a torque in thousandths of the rated one, brake released.
inline ServoCommand torque(double permille) {
  ServoCommand c;
  c.loop = ServoCommand::Loop::torque;
  c.torque = permille;
  c.brake_released = true;
  c.torque_limit_positive = c.torque_limit_negative = 3000;
  return c;
}
inline void run(Plant& plant, const ServoCommand& c, double seconds) {
  for (double t = 0; t < seconds; t += kStepS) plant.step(c);
}

}  // namespace servogate::mock
