// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/servo_loops.hpp"

#include <algorithm>

#include "drivers/mock/drive/plant.hpp"

namespace servogate::mock {
namespace {

constexpr double kDefaultVelocityBandwidth = 600.0;  // rad/s

}  // namespace

double total_inertia_of(const PlantConfig& c) noexcept {
  return c.inertia_kg_m2 + std::max(0.0, c.load_inertia_kg_m2);
}

double velocity_gain_of(const PlantConfig& c) noexcept {
  return c.velocity_gain > 0.0 ? c.velocity_gain : total_inertia_of(c) * kDefaultVelocityBandwidth;
}

double servo_torque(const ServoGains& gains, const canopen::ServoCommand& command, double torque,
                    const ServoMeasured& measured, double low, double high, double& integral) noexcept {
  double velocity = command.velocity;
  if (command.loop == canopen::ServoCommand::Loop::position)
    velocity += gains.position_gain * (command.position - measured.position_counts);
  const double error = velocity * gains.rad_per_count - measured.velocity_rad_s;
  torque += gains.inertia_kg_m2 * command.acceleration * gains.rad_per_count + gains.velocity_gain * error;
  const double wanted = torque + integral;
  if (!(wanted > high && error > 0.0) && !(wanted < low && error < 0.0))
    integral += gains.integral_step * error;
  return torque + integral;
}

}  // namespace servogate::mock
