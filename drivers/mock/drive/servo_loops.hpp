// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/device/drive/servo.hpp"

namespace servogate::mock {

struct PlantConfig;

/// Position and velocity loop of a simulated drive: P and PI, with the velocity and acceleration of the
/// command fed forward.
struct ServoGains {
  double position_gain = 0.0;  ///< 1/s
  double velocity_gain = 0.0;  ///< N m s/rad
  double integral_step = 0.0;  ///< velocity_gain times integral rate (1/s) times step of the loop (s)
  double inertia_kg_m2 = 0.0;  ///< of the acceleration that is fed forward
  double rad_per_count = 0.0;
};
/// What they measure.
struct ServoMeasured {
  double position_counts = 0.0;
  double velocity_rad_s = 0.0;
};

/// What the loops add to the torque of a command (N m), which is limited to `low` ... `high` behind them; the
/// integral is carried from step to step and stands still in the direction of a limit. real-time safe.
inline double servo_torque(const ServoGains& gains, const canopen::ServoCommand& command, double torque_nm,
                           const ServoMeasured& measured, double low, double high,
                           double& integral) noexcept {
  double velocity = command.velocity;
  if (command.loop == canopen::ServoCommand::Loop::position)
    velocity += gains.position_gain * (command.position - measured.position_counts);
  const double error = velocity * gains.rad_per_count - measured.velocity_rad_s;
  torque_nm += gains.inertia_kg_m2 * command.acceleration * gains.rad_per_count + gains.velocity_gain * error;
  const double wanted = torque_nm + integral;
  if (!(wanted > high && error > 0.0) && !(wanted < low && error < 0.0))
    integral += gains.integral_step * error;
  return torque_nm + integral;
}

/// A notch in the torque, (s^2 + 2 d w s + w^2) / (s^2 + 2 w s + w^2), sampled with its centre in place. All
/// of it is real-time safe.
class NotchFilter {
 public:
  /// Centre in Hz, d, and the time between two values in s. Up to 0.45 of their rate; beyond that, and at 0,
  /// it lets everything through.
  void set(double hz, double depth, double step) noexcept;
  double operator()(double x) noexcept;
  void reset() noexcept { z1_ = z2_ = 0.0; }

 private:
  double hz_ = 0.0, depth_ = 1.0;
  double b0_ = 1.0, b1_ = 0.0, b2_ = 0.0, a1_ = 0.0, a2_ = 0.0, z1_ = 0.0, z2_ = 0.0;
};

/// N m s/rad, as the configuration says or as it follows from the inertia.
double velocity_gain_of(const PlantConfig& config) noexcept;
/// kg m2 of motor and load.
double total_inertia_of(const PlantConfig& config) noexcept;

/// The objects by which a master tunes these loops, which CiA 402 leaves to the maker of the drive: units of
/// one millionth or thousandth.
namespace tuning_object {
/// :01 gain, 1e-6 N m s/rad; :02 integral, 1e-3 1/s; :03 notch, 1e-3 Hz, 0: none; :04 what it leaves, 1e-3
inline constexpr std::uint16_t kVelocityLoop = 0x60F9;
inline constexpr std::uint16_t kPositionLoop = 0x60FB;  ///< :01 gain, 1e-3 1/s
}  // namespace tuning_object

}  // namespace servogate::mock
