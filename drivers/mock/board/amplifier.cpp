// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/board/amplifier.hpp"

#include <cmath>

namespace servogate::mock {

void Amplifier::set_enable(bool on) noexcept {
  enabled_ = on;
  if (!on) speed_ = 0.0;
}

void Amplifier::set_step(bool step, bool forward, image::Nanoseconds t) noexcept {
  const bool rises = step && !step_;
  step_ = step;
  if (!rises || !enabled_ || config_.steps_per_rev <= 0) return;
  const double span = static_cast<double>(t - last_step_ns_) * 1e-9;
  last_step_ns_ = t;
  // Beyond its pull-out speed the rotor falls behind: the step is not followed.
  if (config_.pull_out > 0.0 && span * config_.pull_out * static_cast<double>(config_.steps_per_rev) < 1.0) {
    ++lost_;
    return;
  }
  steps_ += forward != config_.reversed ? 1 : -1;
  turn_to(config_.start + static_cast<double>(steps_) / static_cast<double>(config_.steps_per_rev));
}

void Amplifier::advance(double dt) noexcept {
  if (config_.steps_per_rev > 0) return;
  if (!enabled_) return;
  const double wanted = (value_ + config_.drift) * config_.full_speed * (config_.reversed ? -1.0 : 1.0);
  const double before = speed_;
  speed_ += (wanted - speed_) * (config_.lag_s > 0.0 ? 1.0 - std::exp(-dt / config_.lag_s) : 1.0);
  turn_to(revolutions_ + 0.5 * (before + speed_) * dt);
}

/// An index that is passed captures the counter there.
void Amplifier::turn_to(double to) noexcept {
  const double from = revolutions_;
  revolutions_ = to;
  if (!armed_ || captured_) return;
  const double first = std::floor(from - config_.zero_mark), last = std::floor(to - config_.zero_mark);
  if (first == last) return;
  const double index = (to > from ? first + 1.0 : first) + config_.zero_mark;
  captured_counts_ = counts_at(index);
  captured_ = true;
}

std::int32_t Amplifier::counts_at(double revolutions) const noexcept {
  const double counts =
      std::round((revolutions - config_.start) * static_cast<double>(config_.counts_per_rev));
  return static_cast<std::int32_t>(
      static_cast<std::uint32_t>(static_cast<std::int64_t>(counts) & 0xFFFFFFFF));
}

std::int32_t Amplifier::counts() const noexcept { return counts_at(revolutions_); }

bool Amplifier::take_index(std::int32_t& counts) noexcept {
  if (!captured_) return false;
  captured_ = false;
  armed_ = false;
  counts = captured_counts_;
  return true;
}

}  // namespace servogate::mock
