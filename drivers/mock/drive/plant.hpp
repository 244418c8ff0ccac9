// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/device/drive/servo.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::mock {

/// Motor, load and servo loops of a simulated axis, all at the motor shaft. SI units.
struct PlantConfig {
  std::int64_t counts_per_rev = 262'144;  ///< resolution of the encoder
  double inertia_kg_m2 = 1.0e-3;          ///< rotor and load; with a compliant coupling the rotor alone
  double coulomb_friction_nm = 0.1;       ///< dry friction, also what holds at rest
  double viscous_friction_nm_s = 5.0e-4;  ///< per rad/s
  /// Stribeck: what dry friction has more at rest; at speed w it has stribeck * exp(-(w / stribeck_speed)^2)
  /// more.
  double stribeck_friction_nm = 0.0;
  double stribeck_speed_rad_s = 5.0;
  double load_torque_nm = 0.0;  ///< constant, e.g. gravity of a vertical axis; + pulls towards minus
  /// A load against the motion, as friction, that comes every period for some time: a cut on a spindle.
  double dip_torque_nm = 0.0, dip_period_s = 1.0, dip_time_s = 0.1;
  double rated_torque_nm = 2.4;    ///< 1000 permille of 6071h, 6077h
  double peak_torque_nm = 7.2;     ///< what the power stage can give
  double max_speed_rad_s = 524.0;  ///< no torque beyond it in that direction (voltage limit); 5000 rpm
  double current_time_constant_s = 3.0e-4;  ///< torque follows its command as a first-order lag
  double position_gain = 120.0;             ///< 1/s
  double velocity_gain = 0.0;               ///< N m s/rad; 0: inertia * 600/s
  double velocity_integral = 60.0;          ///< 1/s, reciprocal of the integral time
  double brake_torque_nm = 0.0;             ///< of a closed holding brake; 0: there is no brake
  double brake_release_s = 0.05;            ///< from its command until it gives way; the drive waits as long
  double brake_engage_s = 0.05;             ///< from its command until it holds
  std::int64_t zero_mark_counts =
      0;  ///< place of the zero mark inside a revolution, 0 ... counts_per_rev - 1
  double end_stop_min_rev = -1.0e12;  ///< rigid stops, revolutions of the shaft from the world's zero
  double end_stop_max_rev = 1.0e12;
  double start_rev = 0.0;  ///< where the shaft stands at the start

  double cogging_nm = 0.0;        ///< amplitude of the torque that pulls the rotor towards its poles
  double cogging_periods = 24.0;  ///< of it in a revolution
  /// Compliance: the load behind a spring. The encoder sits at the motor; friction, gravity and rigid stops
  /// act on the load.
  double load_inertia_kg_m2 = 0.0;
  double stiffness_nm_rad = 0.0;  ///< of the coupling; 0: rigid
  double damping_nm_s = 0.0;      ///< in the coupling, per rad/s
  /// Play between motor and load, the whole gap, at the motor shaft; it needs a compliant coupling, which
  /// works where the gap is closed. Motor and load start in its middle.
  double backlash_rad = 0.0;
  /// Standard deviation of what the measured torque is off, bell-shaped, white and the same at every run.
  double torque_noise_nm = 0.0;
  /// The most that a reading of the encoder is off, evenly spread, the same at every run; also what the
  /// position loop goes by.
  double encoder_noise_counts = 0.0;
  /// I2t: thermal time constant of the motor, which takes its rated torque for ever; 0: it never gets too
  /// hot.
  double thermal_time_s = 0.0;
};

/// The motor with its load, integrated semi-implicitly with a fixed step: dry friction is exact (it holds,
/// and it never reverses a motion), viscous friction is unconditionally stable. A compliant coupling is
/// integrated in steps short against its resonance. Deterministic. real-time safe.
class Plant {
 public:
  Plant(const PlantConfig& config, image::Nanoseconds step_ns);

  /// One step under a command. Positions of the command are encoder counts (see encoder_counts()).
  void step(const canopen::ServoCommand& command) noexcept;

  /// What the drive's electronics measure. real-time safe.
  const canopen::ServoState& state() const noexcept { return state_; }
  /// True angle of the load in revolutions from the world's zero. real-time safe.
  double revolutions() const noexcept {
    return (compliant() ? load_counts_ : counts_) * revolutions_per_count_;
  }
  /// True position of the motor in counts from the world's zero, rounded down. real-time safe.
  std::int64_t counts() const noexcept { return whole_counts_; }
  double velocity_rad_s() const noexcept { return omega_; }
  double torque_nm() const noexcept { return torque_; }
  bool at_end_stop() const noexcept { return at_stop_; }
  /// Heat of the motor, 1: what the rated torque leads to in the end. 0 without a model of it. real-time
  /// safe.
  double thermal() const noexcept { return thermal_; }
  /// Kinetic energy in J. real-time safe.
  double kinetic_energy() const noexcept;

  /// Replaces the constant load. real-time safe.
  void set_load_torque(double nm) noexcept { load_torque_ = nm; }
  /// Moves the shaft (a hand on the handwheel, a crash): position only, at rest.
  void place_at(double revolutions) noexcept;
  /// Adds an error to what the encoder says from now on (lost counts). real-time safe.
  void jump_encoder(std::int64_t counts) noexcept { encoder_error_ += counts; }

 private:
  double loop_torque(const canopen::ServoCommand& command) noexcept;
  void integrate(double torque_command, bool brake_closed) noexcept;
  void integrate_compliant(double torque_command, bool brake_closed) noexcept;
  bool compliant() const noexcept { return substeps_ > 0; }
  bool brake_closed(bool released) noexcept;
  double cogging() const noexcept;
  double dry_friction(double omega) const noexcept;
  double coupling_torque() const noexcept;
  double even_noise() noexcept;
  double noise() noexcept;
  double stopped_at_rigid_stops(double& counts, double omega) noexcept;
  void measure() noexcept;
  void find_marks() noexcept;

  PlantConfig config_;
  double h_;
  // Derived once.
  double revolutions_per_count_, rad_per_count_, counts_per_rad_;
  double lag_, h_over_j_, viscous_divisor_, brake_step_;
  double permille_to_nm_, nm_to_permille_, velocity_gain_, integral_step_;
  double stop_min_counts_, stop_max_counts_;
  double total_inertia_, cogging_per_count_, thermal_step_ = 0.0;
  int substeps_ = 0;                                        ///< of a compliant coupling in a step; 0: rigid
  std::int64_t steps_ = 0, dip_every_ = 1, dip_steps_ = 0;  ///< so far; of the load that comes and goes
  double sub_h_ = 0.0, sub_lag_ = 0.0, sub_over_motor_ = 0.0, sub_over_load_ = 0.0,
         load_viscous_divisor_ = 1.0;
  // State.
  double counts_ = 0.0;  ///< true position, counts with fraction
  std::int64_t whole_counts_ = 0;
  double omega_ = 0.0;
  double load_counts_ = 0.0, load_omega_ = 0.0;  ///< behind a compliant coupling
  double thermal_ = 0.0;
  double torque_ = 0.0;
  double integral_ = 0.0;
  double load_torque_;
  bool at_stop_ = false;
  bool brake_holds_ = true;
  double brake_moves_ = 0.0;                      ///< s since it was told to change
  std::int64_t mark_below_ = 0, mark_above_ = 0;  ///< zero marks around the shaft, true counts
  std::int64_t encoder_error_ = 0;
  std::uint64_t noise_state_ = 0x9E37'79B9'7F4A'7C15;
  canopen::ServoState state_;
};

}  // namespace servogate::mock
