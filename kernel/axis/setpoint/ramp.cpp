// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/setpoint/ramp.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::axis {

namespace {

struct Piece {
  double duration = 0.0, jerk = 0.0;
};
struct Pieces {
  std::array<Piece, 4> items;
  int count = 0;
  void add(double duration, double jerk) {
    if (duration > 0.0) items[static_cast<std::size_t>(count++)] = {duration, jerk};
  }
};

MotionState after(const MotionState& s, double t, double j) {
  return {s.x + t * (s.v + t * (s.a / 2 + t * j / 6)), s.v + t * (s.a + t * j / 2), s.a + t * j};
}

/// Time-optimal way from (v, a) to (velocity, 0): jerk, constant acceleration, opposite jerk; before it the
/// way back to the permitted acceleration, where the state is outside.
Pieces velocity_ramp(double v, double a, double velocity, const MotionLimits& lim) {
  Pieces out;
  const double j = lim.jerk, a_max = lim.acceleration;
  if (std::abs(a) > a_max) {
    const double back = -std::copysign(j, a), t = (std::abs(a) - a_max) / j;
    out.add(t, back);
    v += t * (a + t * back / 2);
    a = std::copysign(a_max, a);
  }
  const double without_a = v + a * std::abs(a) / (2 * j);
  const double sign = velocity >= without_a ? 1.0 : -1.0;
  const double a0 = sign * a, dv = sign * (velocity - v);
  double peak = std::sqrt(std::max(0.0, j * dv + a0 * a0 / 2));
  double hold = 0.0;
  if (peak > a_max) {
    peak = a_max;
    hold = std::max(0.0, (dv - (2 * peak * peak - a0 * a0) / (2 * j)) / peak);
  }
  peak = std::max(peak, std::max(a0, 0.0));
  out.add((peak - a0) / j, sign * j);
  out.add(hold, 0.0);
  out.add(peak / j, -sign * j);
  return out;
}

double displacement(double v, double a, const Pieces& pieces) {
  MotionState s{0.0, v, a};
  for (int i = 0; i < pieces.count; ++i) {
    const Piece& p = pieces.items[static_cast<std::size_t>(i)];
    s = after(s, p.duration, p.jerk);
  }
  return s.x;
}

/// Way of the ramp from a velocity without acceleration down to rest (velocity >= 0).
double way_to_rest(double velocity, const MotionLimits& lim) {
  const double t = velocity * lim.jerk >= lim.acceleration * lim.acceleration
                       ? velocity / lim.acceleration + lim.acceleration / lim.jerk
                       : 2 * std::sqrt(velocity / lim.jerk);
  return velocity * t / 2;
}

/// Peak and cruise of a move over `distance` from (v, a), mirrored so that the peak is not negative.
struct Peak {
  double velocity = 0.0, cruise_s = 0.0;
};

double way_over(double v, double a, double peak, const MotionLimits& lim) {
  return displacement(v, a, velocity_ramp(v, a, peak, lim)) + way_to_rest(peak, lim);
}

Peak find_peak(double v, double a, double distance, const MotionLimits& lim) {
  const double clamped = std::clamp(a, -lim.acceleration, lim.acceleration);
  double low = std::clamp(v + clamped * std::abs(clamped) / (2 * lim.jerk), 0.0, lim.velocity);
  double high = lim.velocity;
  if (way_over(v, a, low, lim) > distance) {
    high = low;
    low = 0.0;
  }
  if (way_over(v, a, high, lim) <= distance) {
    low = high;
  } else {
    for (int i = 0; i < 60; ++i) {
      const double middle = low + (high - low) / 2;
      (way_over(v, a, middle, lim) <= distance ? low : high) = middle;
    }
  }
  const double rest = distance - way_over(v, a, low, lim);
  // Below this the rest is rounding of the sums above; the exact end takes it up.
  const double rounding = 1e-13 * (1.0 + std::abs(distance));
  return {low, low > 0.0 && rest > rounding ? rest / low : 0.0};
}

}  // namespace

double Ramp::stopping_distance(const MotionState& s, const MotionLimits& limits) noexcept {
  return displacement(s.v, s.a, velocity_ramp(s.v, s.a, 0.0, limits));
}

void Ramp::append(double duration, double jerk) noexcept {
  if (!(duration > 0.0) || count_ == kMaxPhases) return;
  phases_[static_cast<std::size_t>(count_++)] = {duration, jerk, end_};
  end_ = after(end_, duration, jerk);
  left_ += duration;
}

void Ramp::append_velocity_ramp(double velocity, int sign) noexcept {
  const Pieces pieces = velocity_ramp(sign * end_.v, sign * end_.a, velocity, limits_);
  for (int i = 0; i < pieces.count; ++i) {
    const Piece& p = pieces.items[static_cast<std::size_t>(i)];
    append(p.duration, sign * p.jerk);
  }
  end_.v = sign * velocity;
  end_.a = 0.0;
}

void Ramp::begin(const MotionLimits& limits) noexcept {
  limits_ = limits;
  count_ = phase_ = 0;
  local_ = left_ = 0.0;
  end_ = state_;
}

void Ramp::reset(const MotionState& state, const MotionLimits& limits) noexcept {
  state_ = state;
  begin(limits);
  to_position_ = false;
  target_velocity_ = 0.0;
  append_velocity_ramp(0.0, 1);
}

void Ramp::move_to(double target, const MotionLimits& limits) noexcept {
  if (to_position_ && target == target_ && limits == limits_) return;
  begin(limits);
  to_position_ = true;
  target_ = target;
  target_velocity_ = 0.0;
  const double distance = target - state_.x;
  const int sign = distance >= stopping_distance(state_, limits) ? 1 : -1;
  const Peak peak = find_peak(sign * state_.v, sign * state_.a, sign * distance, limits);
  append_velocity_ramp(peak.velocity, sign);
  append(peak.cruise_s, 0.0);
  append_velocity_ramp(0.0, sign);
  end_ = {target, 0.0, 0.0};
}

void Ramp::move_at(double velocity, const MotionLimits& limits) noexcept {
  const double wanted = std::clamp(velocity, -limits.velocity, limits.velocity);
  if (!to_position_ && wanted == target_velocity_ && limits == limits_) return;
  begin(limits);
  to_position_ = false;
  target_velocity_ = wanted;
  append_velocity_ramp(wanted, 1);
}

const MotionState& Ramp::step(double dt) noexcept {
  local_ += dt;
  left_ -= dt;
  while (phase_ < count_ && local_ >= phases_[static_cast<std::size_t>(phase_)].duration)
    local_ -= phases_[static_cast<std::size_t>(phase_++)].duration;
  if (phase_ < count_) {
    const Phase& p = phases_[static_cast<std::size_t>(phase_)];
    state_ = after(p.start, local_, p.jerk);
  } else {
    state_ = after(end_, end_.v == 0.0 ? 0.0 : local_, 0.0);
  }
  return state_;
}

void Ramp::shift(double delta) noexcept {
  state_.x += delta;
  end_.x += delta;
  target_ += delta;
  for (int i = 0; i < count_; ++i) phases_[static_cast<std::size_t>(i)].start.x += delta;
}

}  // namespace servogate::axis
