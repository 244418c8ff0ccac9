// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace servogate::mock {
namespace {

constexpr double kDefaultVelocityBandwidth = 600.0;  // rad/s

std::int64_t floor_to_int(double x) noexcept {
  const auto i = static_cast<std::int64_t>(x);
  return i - (x < static_cast<double>(i));
}

}  // namespace

Plant::Plant(const PlantConfig& config, image::Nanoseconds step_ns)
    : config_(config), h_(static_cast<double>(step_ns) * 1e-9), load_torque_(config.load_torque_nm) {
  if (config.counts_per_rev <= 0 || config.inertia_kg_m2 <= 0.0 || config.rated_torque_nm <= 0.0 ||
      step_ns <= 0)
    throw std::invalid_argument("a plant needs counts, inertia, torque and a step above zero");
  const auto turn = static_cast<double>(config.counts_per_rev);
  revolutions_per_count_ = 1.0 / turn;
  rad_per_count_ = 2.0 * std::numbers::pi / turn;
  counts_per_rad_ = 1.0 / rad_per_count_;
  lag_ = config.current_time_constant_s > 0.0 ? -std::expm1(-h_ / config.current_time_constant_s) : 1.0;
  h_over_j_ = h_ / config.inertia_kg_m2;
  viscous_divisor_ = 1.0 / (1.0 + h_over_j_ * config.viscous_friction_nm_s);
  friction_step_ = h_over_j_ * config.coulomb_friction_nm * viscous_divisor_;
  brake_step_ = h_over_j_ * config.brake_torque_nm * viscous_divisor_;
  permille_to_nm_ = config.rated_torque_nm / 1000.0;
  nm_to_permille_ = 1000.0 / config.rated_torque_nm;
  velocity_gain_ =
      config.velocity_gain > 0.0 ? config.velocity_gain : config.inertia_kg_m2 * kDefaultVelocityBandwidth;
  integral_step_ = velocity_gain_ * config.velocity_integral * h_;
  stop_min_counts_ = config.end_stop_min_rev * turn;
  stop_max_counts_ = config.end_stop_max_rev * turn;
  place_at(config.start_rev);
}

void Plant::place_at(double revolutions) noexcept {
  counts_ = std::clamp(revolutions / revolutions_per_count_, stop_min_counts_, stop_max_counts_);
  omega_ = torque_ = integral_ = 0.0;
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

double Plant::kinetic_energy() const noexcept { return 0.5 * config_.inertia_kg_m2 * omega_ * omega_; }

void Plant::step(const canopen::ServoCommand& command) noexcept {
  integrate(loop_torque(command), !command.brake_released);
  measure();
}

// Cascade of position (P with velocity fed forward) and velocity (PI with acceleration fed forward).
double Plant::loop_torque(const canopen::ServoCommand& command) noexcept {
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
    double velocity = command.velocity;
    if (command.loop == Loop::position)
      velocity += config_.position_gain * (command.position - static_cast<double>(state_.position));
    const double error = velocity * rad_per_count_ - omega_;
    torque += config_.inertia_kg_m2 * command.acceleration * rad_per_count_ + velocity_gain_ * error;
    const double wanted = torque + integral_;
    // The integral stands still while the torque is at its limit in that direction.
    if (!(wanted > high && error > 0.0) && !(wanted < low && error < 0.0))
      integral_ += integral_step_ * error;
    torque += integral_;
  }
  state_.saturated = torque > high || torque < low;
  torque = std::clamp(torque, low, high);
  if (omega_ * torque > 0.0 && std::abs(omega_) >= config_.max_speed_rad_s) torque = 0.0;
  return torque;
}

void Plant::integrate(double torque_command, bool brake_closed) noexcept {
  torque_ += lag_ * (torque_command - torque_);
  double omega = (omega_ + h_over_j_ * (torque_ - load_torque_)) * viscous_divisor_;
  const double friction = friction_step_ + (brake_closed ? brake_step_ : 0.0);
  if (std::abs(omega) <= friction) {
    omega = 0.0;
  } else {
    omega -= std::copysign(friction, omega);
  }
  omega_ = omega;
  counts_ += omega * h_ * counts_per_rad_;
  at_stop_ = counts_ <= stop_min_counts_ || counts_ >= stop_max_counts_;
  if (at_stop_) {
    counts_ = std::clamp(counts_, stop_min_counts_, stop_max_counts_);
    if ((counts_ == stop_min_counts_) == (omega_ < 0.0)) omega_ = 0.0;
  }
}

void Plant::measure() noexcept {
  whole_counts_ = floor_to_int(counts_);
  state_.zero_mark = false;
  if (whole_counts_ < mark_below_ || whole_counts_ >= mark_above_) {
    state_.zero_mark = true;
    state_.zero_mark_position = (whole_counts_ < mark_below_ ? mark_below_ : mark_above_) + encoder_error_;
    find_marks();
  }
  state_.position = whole_counts_ + encoder_error_;
  state_.velocity = omega_ * counts_per_rad_;
  state_.torque = torque_ * nm_to_permille_;
}

}  // namespace servogate::mock
