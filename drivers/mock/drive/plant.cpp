// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "drivers/mock/drive/servo_loops.hpp"

namespace servogate::mock {
namespace {

/// A compliant coupling is integrated in steps of at most this angle of its resonance, rad.
constexpr double kResonanceStep = 0.2;
constexpr int kMostSubsteps = 64;

/// Dry friction: it brings to rest and holds, and never reverses a motion.
double with_dry_friction(double omega, double step) noexcept {
  return std::abs(omega) <= step ? 0.0 : omega - std::copysign(step, omega);
}

std::int64_t floor_to_int(double x) noexcept {
  const auto i = static_cast<std::int64_t>(x);
  return i - (x < static_cast<double>(i));
}

}  // namespace

inline void Plant::measure() noexcept {
  whole_counts_ = floor_to_int(counts_);
  state_.zero_mark = false;
  if (whole_counts_ < mark_below_ || whole_counts_ >= mark_above_) {
    state_.zero_mark = true;
    state_.zero_mark_position = (whole_counts_ < mark_below_ ? mark_below_ : mark_above_) + encoder_error_;
    find_marks();
  }
  state_.position = whole_counts_ + encoder_error_;
  if (config_.encoder_noise_counts > 0.0)
    state_.position += std::llround(2.0 * config_.encoder_noise_counts * even_noise());
  state_.velocity = omega_ * counts_per_rad_;
  const double off = config_.torque_noise_nm > 0.0 ? config_.torque_noise_nm * noise() : 0.0;
  state_.torque = (torque_ + off) * nm_to_permille_;
}

Plant::Plant(const PlantConfig& config, image::Nanoseconds step_ns)
    : config_(config), h_(static_cast<double>(step_ns) * 1e-9), load_torque_(config.load_torque_nm) {
  if (config.counts_per_rev <= 0 || config.inertia_kg_m2 <= 0.0 || config.rated_torque_nm <= 0.0 ||
      step_ns <= 0)
    throw std::invalid_argument("a plant needs counts, inertia, torque and a step above zero");
  if (config.stribeck_friction_nm < 0.0 || config.stribeck_speed_rad_s <= 0.0 || config.backlash_rad < 0.0 ||
      config.torque_noise_nm < 0.0 || config.dip_torque_nm < 0.0 || config.encoder_noise_counts < 0.0)
    throw std::invalid_argument("a plant needs friction, backlash, dips and noise of no negative size");
  const bool spring = config.stiffness_nm_rad > 0.0 && config.load_inertia_kg_m2 > 0.0;
  if (config.backlash_rad > 0.0 && !spring)
    throw std::invalid_argument("backlash needs a load behind a coupling: load inertia and stiffness");
  total_inertia_ = total_inertia_of(config);
  // A rigid coupling makes one mass of both.
  if (!spring) config_.inertia_kg_m2 = total_inertia_;
  const auto turn = static_cast<double>(config.counts_per_rev);
  revolutions_per_count_ = 1.0 / turn;
  rad_per_count_ = 2.0 * std::numbers::pi / turn;
  counts_per_rad_ = 1.0 / rad_per_count_;
  lag_ = config.current_time_constant_s > 0.0 ? -std::expm1(-h_ / config.current_time_constant_s) : 1.0;
  h_over_j_ = h_ / config_.inertia_kg_m2;
  viscous_divisor_ = 1.0 / (1.0 + h_over_j_ * config.viscous_friction_nm_s);
  brake_step_ = h_over_j_ * config.brake_torque_nm * viscous_divisor_;
  permille_to_nm_ = config.rated_torque_nm / 1000.0;
  nm_to_permille_ = 1000.0 / config.rated_torque_nm;
  velocity_gain_ = velocity_gain_of(config);
  integral_step_ = velocity_gain_ * config.velocity_integral * h_;
  stop_min_counts_ = config.end_stop_min_rev * turn;
  stop_max_counts_ = config.end_stop_max_rev * turn;
  cogging_per_count_ = config.cogging_periods * rad_per_count_;
  if (config.thermal_time_s > 0.0) thermal_step_ = -std::expm1(-h_ / config.thermal_time_s);
  if (config.dip_torque_nm > 0.0) {
    dip_every_ = std::max<std::int64_t>(1, std::llround(config.dip_period_s / h_));
    dip_steps_ = std::llround(config.dip_time_s / h_);
  }
  if (spring) {
    const double resonance =
        std::sqrt(config.stiffness_nm_rad * (1.0 / config.inertia_kg_m2 + 1.0 / config.load_inertia_kg_m2));
    substeps_ = std::clamp(static_cast<int>(std::ceil(h_ * resonance / kResonanceStep)), 1, kMostSubsteps);
    sub_h_ = h_ / substeps_;
    sub_lag_ =
        config.current_time_constant_s > 0.0 ? -std::expm1(-sub_h_ / config.current_time_constant_s) : 1.0;
    sub_over_motor_ = sub_h_ / config.inertia_kg_m2;
    sub_over_load_ = sub_h_ / config.load_inertia_kg_m2;
    load_viscous_divisor_ = 1.0 / (1.0 + sub_over_load_ * config.viscous_friction_nm_s);
  }
  place_at(config.start_rev);
}

void Plant::place_at(double revolutions) noexcept {
  counts_ = std::clamp(revolutions / revolutions_per_count_, stop_min_counts_, stop_max_counts_);
  load_counts_ = counts_;
  omega_ = load_omega_ = torque_ = integral_ = 0.0;
  whole_counts_ = floor_to_int(counts_);
  find_marks();
  measure();
}

void Plant::find_marks() noexcept {
  const std::int64_t turn = config_.counts_per_rev;
  std::int64_t phase = (whole_counts_ - config_.zero_mark_counts) % turn;
  if (phase < 0) phase += turn;
  mark_below_ = whole_counts_ - phase;
  mark_above_ = mark_below_ + turn;
}

double Plant::kinetic_energy() const noexcept {
  const double load = compliant() ? config_.load_inertia_kg_m2 * load_omega_ * load_omega_ : 0.0;
  return 0.5 * (config_.inertia_kg_m2 * omega_ * omega_ + load);
}

void Plant::step(const canopen::ServoCommand& command) noexcept {
  const double torque = loop_torque(command);
  const bool closed = brake_closed(command.brake_released);
  if (compliant())
    integrate_compliant(torque, closed);
  else
    integrate(torque, closed);
  if (thermal_step_ > 0.0) {
    const double load = torque_ / config_.rated_torque_nm;
    thermal_ += thermal_step_ * (load * load - thermal_);
  }
  steps_ += dip_steps_ > 0;
  measure();
}

/// Spring and magnet take their time, either way.
inline bool Plant::brake_closed(bool released) noexcept {
  if (released != brake_holds_) {
    brake_moves_ = 0.0;
    return brake_holds_;
  }
  brake_moves_ += h_;
  if (brake_moves_ > (released ? config_.brake_release_s : config_.brake_engage_s)) {
    brake_holds_ = !released;
    brake_moves_ = 0.0;
  }
  return brake_holds_;
}

double Plant::cogging() const noexcept {
  return config_.cogging_nm != 0.0 ? config_.cogging_nm * std::sin(counts_ * cogging_per_count_) : 0.0;
}

inline double Plant::dry_friction(double omega) const noexcept {
  const bool dips = dip_steps_ > 0 && steps_ % dip_every_ < dip_steps_;
  const double coulomb = config_.coulomb_friction_nm + (dips ? config_.dip_torque_nm : 0.0);
  if (config_.stribeck_friction_nm == 0.0) return coulomb;
  const double x = omega / config_.stribeck_speed_rad_s;
  return coulomb + config_.stribeck_friction_nm * std::exp(-x * x);
}

/// From motor to load. Within the gap there is none, and where it is closed the faces press and never pull.
double Plant::coupling_torque() const noexcept {
  const double twist = (counts_ - load_counts_) * rad_per_count_;
  const double damping = config_.damping_nm_s * (omega_ - load_omega_);
  if (config_.backlash_rad == 0.0) return config_.stiffness_nm_rad * twist + damping;
  const double pressed = std::abs(twist) - 0.5 * config_.backlash_rad;
  if (pressed <= 0.0) return 0.0;
  const double side = std::copysign(1.0, twist);
  return side * std::max(0.0, config_.stiffness_nm_rad * pressed + side * damping);
}

/// Between -0.5 and 0.5. Source: xorshift64*, Vigna 2016.
double Plant::even_noise() noexcept {
  noise_state_ ^= noise_state_ >> 12;
  noise_state_ ^= noise_state_ << 25;
  noise_state_ ^= noise_state_ >> 27;
  return static_cast<double>((noise_state_ * 0x2545'F491'4F6C'DD1DULL) >> 11) * 0x1p-53 - 0.5;
}

/// Sum of four even distributions, of standard deviation 1.
double Plant::noise() noexcept {
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) sum += even_noise();
  return std::numbers::sqrt3 * sum;
}

// Cascade of position (P with velocity fed forward) and velocity (PI with acceleration fed forward).
inline double Plant::loop_torque(const canopen::ServoCommand& command) noexcept {
  using Loop = canopen::ServoCommand::Loop;
  const double peak = config_.peak_torque_nm;
  const double high = std::min(command.torque_limit_positive * permille_to_nm_, peak);
  const double low = -std::min(command.torque_limit_negative * permille_to_nm_, peak);
  double torque = command.torque * permille_to_nm_;
  if (command.loop == Loop::off) {
    integral_ = 0.0;
    return 0.0;
  }
  if (command.loop == Loop::torque) {
    integral_ = 0.0;
  } else {
    const ServoGains gains{config_.position_gain, velocity_gain_, integral_step_, total_inertia_,
                           rad_per_count_};
    torque = servo_torque(gains, command, torque, {static_cast<double>(state_.position), omega_}, low, high,
                          integral_);
  }
  state_.saturated = torque > high || torque < low;
  torque = std::clamp(torque, low, high);
  if (omega_ * torque > 0.0 && std::abs(omega_) >= config_.max_speed_rad_s) torque = 0.0;
  return torque;
}

inline void Plant::integrate(double torque_command, bool brake_closed) noexcept {
  torque_ += lag_ * (torque_command - torque_);
  const double load = config_.cogging_nm != 0.0 ? load_torque_ + cogging() : load_torque_;
  const double omega = (omega_ + h_over_j_ * (torque_ - load)) * viscous_divisor_;
  omega_ = with_dry_friction(
      omega, h_over_j_ * dry_friction(omega_) * viscous_divisor_ + (brake_closed ? brake_step_ : 0.0));
  counts_ += omega_ * h_ * counts_per_rad_;
  omega_ = stopped_at_rigid_stops(counts_, omega_);
}

// Motor and load by turns, semi-implicitly: energy neither grows nor leaks.
void Plant::integrate_compliant(double torque_command, bool brake_closed) noexcept {
  const double brake = brake_closed ? sub_over_motor_ * config_.brake_torque_nm : 0.0;
  for (int i = 0; i < substeps_; ++i) {
    torque_ += sub_lag_ * (torque_command - torque_);
    const double coupling = coupling_torque();
    omega_ = with_dry_friction(omega_ + sub_over_motor_ * (torque_ - coupling - cogging()), brake);
    load_omega_ =
        with_dry_friction((load_omega_ + sub_over_load_ * (coupling - load_torque_)) * load_viscous_divisor_,
                          sub_over_load_ * dry_friction(load_omega_) * load_viscous_divisor_);
    counts_ += omega_ * sub_h_ * counts_per_rad_;
    load_counts_ += load_omega_ * sub_h_ * counts_per_rad_;
    load_omega_ = stopped_at_rigid_stops(load_counts_, load_omega_);
  }
}

/// What is left of a speed at the rigid stops.
inline double Plant::stopped_at_rigid_stops(double& counts, double omega) noexcept {
  at_stop_ = counts <= stop_min_counts_ || counts >= stop_max_counts_;
  if (!at_stop_) return omega;
  counts = std::clamp(counts, stop_min_counts_, stop_max_counts_);
  return (counts == stop_min_counts_) == (omega < 0.0) ? 0.0 : omega;
}

}  // namespace servogate::mock
