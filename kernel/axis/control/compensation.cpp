// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/control/compensation.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::axis {

void Compensation::configure(const AxisConfig& config) {
  points_.assign(config.pitch.begin(),
                 config.pitch.begin() + std::min<std::ptrdiff_t>(std::ssize(config.pitch), kMaxPoints));
  backlash_ = config.backlash;
  double step = backlash_;
  for (const PitchPoint& p : points_) step = std::max(step, std::abs(p.plus - p.minus - backlash_));
  present_ = backlash_ > 0.0 || !points_.empty();
  const double span = std::max(step, 1e-6);
  side_limits_ = {config.limits.velocity / span, config.limits.acceleration / span,
                  config.limits.jerk / span};
  // Half a count: less is rounding and no reversal.
  hysteresis_ =
      0.5 * static_cast<double>(config.counts_denominator) / static_cast<double>(config.counts_numerator);
  const HomingData& homing = config.homing;
  const bool by_release =
      homing.method == HomingMethod::switch_and_index || homing.method == HomingMethod::switch_only;
  const int direction = by_release ? homing.release_direction : homing.direction;
  zero_ = 0.0;
  zero_ = table(homing.position, direction > 0 ? 1.0 : 0.0);
  seat(homing.position, direction);
}

double Compensation::table(double position, double side) const noexcept {
  double plus = 0.0, minus = 0.0;
  if (!points_.empty()) {
    const auto above = std::upper_bound(points_.begin(), points_.end(), position,
                                        [](double x, const PitchPoint& p) { return x < p.position; });
    if (above == points_.begin()) {
      plus = points_.front().plus, minus = points_.front().minus;
    } else if (above == points_.end()) {
      plus = points_.back().plus, minus = points_.back().minus;
    } else {
      const PitchPoint &a = *(above - 1), &b = *above;
      const double part = (position - a.position) / (b.position - a.position);
      plus = a.plus + part * (b.plus - a.plus);
      minus = a.minus + part * (b.minus - a.minus);
    }
  }
  return minus + side * (plus - minus + backlash_) - zero_;
}

double Compensation::step(double position, double dt) noexcept {
  if (!present_) return 0.0;
  const double moved = position - last_;
  last_ = position;
  if (moved * direction_ > 0.0) {
    reversal_ = 0.0;
  } else if (moved != 0.0) {
    reversal_ += moved;
    if (std::abs(reversal_) > hysteresis_) {
      direction_ = -direction_;
      reversal_ = 0.0;
    }
  }
  side_.move_to(direction_ > 0 ? 1.0 : 0.0, side_limits_);
  return table(position, side_.step(dt).x);
}

double Compensation::at(double position) const noexcept { return present_ ? table(position, side()) : 0.0; }

void Compensation::seat(double position, int direction) noexcept {
  last_ = position;
  reversal_ = 0.0;
  if (direction == 0) return;
  direction_ = direction;
  side_.reset({direction > 0 ? 1.0 : 0.0, 0.0, 0.0}, side_limits_);
}

}  // namespace servogate::axis
