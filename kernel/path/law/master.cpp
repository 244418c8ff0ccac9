// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/master.hpp"

#include <cmath>
#include <functional>

namespace servogate::path {
namespace {

constexpr double kSettled = 8.0 / MasterEstimate::kForgets;  // s until the begin is forgotten
constexpr double kJump = 0.25;                               // revolutions: another zero, no motion
constexpr double kLongest = 0.1;                             // s between two readings

double seconds(image::Nanoseconds t) noexcept { return static_cast<double>(t) * 1e-9; }

MasterState after(const MasterState& s, double t) noexcept {
  return {s.n + t * (s.w + 0.5 * t * s.a), s.w + t * s.a, s.a};
}

}  // namespace

void MasterEstimate::begin(const MasterReading& reading) noexcept {
  *this = MasterEstimate{};
  zero_ = reading.turns;
  state_.n = read_ = reading.part;
  at_ns_ = begun_ns_ = reading.at_ns;
  acts_ns_ = fresh_ns_ = reading.acts_ns;
  begun_ = fresh_ = true;
  lost_ = false;
}

void MasterEstimate::take(const MasterReading& reading) noexcept {
  fresh_ = false;
  if (!reading.valid) {
    begun_ = settled_ = false;
    lost_ = true;
    return;
  }
  if (!begun_) return begin(reading);
  acts_ns_ = reading.acts_ns;
  const double dt = seconds(reading.at_ns - at_ns_);
  if (dt <= 0.0) {
    lost_ = seconds(acts_ns_ - fresh_ns_) > kPatience;
    return;
  }
  const MasterState now = after(state_, dt);
  const double read = static_cast<double>(reading.turns - zero_) + reading.part;
  const double off = read - now.n;
  if (!moves_) {
    // The first two readings give the speed to begin with.
    moves_ = true;
    state_ = {read, off / dt, 0.0};
    read_ = read;
    at_ns_ = reading.at_ns;
    fresh_ns_ = acts_ns_;
    fresh_ = true;
    return;
  }
  if (dt > kLongest || std::abs(off) > kJump + std::abs(now.w) * dt) return begin(reading);
  const double keeps = std::exp(-kForgets * dt), takes = 1.0 - keeps;
  state_.n = now.n + (1.0 - keeps * keeps * keeps) * off;
  state_.w = now.w + 1.5 * takes * takes * (1.0 + keeps) * off / dt;
  state_.a = now.a + takes * takes * takes * off / (dt * dt);
  read_ = read;
  at_ns_ = reading.at_ns;
  fresh_ns_ = acts_ns_;
  fresh_ = true;
  lost_ = false;
  settled_ = settled_ || seconds(at_ns_ - begun_ns_) >= kSettled;
}

MasterState MasterEstimate::at(image::Nanoseconds t_ns) const noexcept {
  return after(state_, seconds(t_ns - at_ns_));
}

namespace {

/// Sum of what a set-point is off, cycle by cycle, behind a master that moves as `turns` says after n cycles
/// and reads `off` more.
double summed_error(const MasterQuality& q, const std::function<double(int)>& turns,
                    const std::function<double(int)>& off) {
  const auto period = static_cast<image::Nanoseconds>(std::llround(q.period_s * 1e9));
  const auto dead = static_cast<image::Nanoseconds>(std::llround(q.dead_time_s * 1e9));
  const double late = q.dead_time_s / q.period_s;
  MasterEstimate estimate;
  double s = 0.0, v = 0.0, a = 0.0, sum = 0.0;
  const int settled = static_cast<int>(1.0 / q.period_s), cycles = 3 * settled;
  for (int k = -settled; k < cycles; ++k) {
    MasterReading reading;
    reading.valid = true;
    const double at = k - late;  // of the reading, in cycles
    const double read = 0.5 + turns(static_cast<int>(std::floor(at))) +
                        (at - std::floor(at)) * (turns(static_cast<int>(std::floor(at)) + 1) -
                                                 turns(static_cast<int>(std::floor(at)))) +
                        off(k);
    reading.turns = static_cast<std::int64_t>(std::floor(read));
    reading.part = read - std::floor(read);
    reading.acts_ns = k * period;
    reading.at_ns = reading.acts_ns - dead;
    estimate.take(reading);
    const MasterState m = estimate.at(reading.acts_ns - period);
    const double j = settling_jerk(m.n - 0.5 - s, m.w - v, m.a - a), dt = q.period_s;
    s += dt * (v + dt * (0.5 * a + dt * j / 6.0));
    v += dt * (a + 0.5 * dt * j);
    a += dt * j;
    sum += std::abs(s - turns(k));
  }
  return sum;
}

}  // namespace

double phase_bound(const MasterQuality& q, double per_turn) {
  const double dt = q.period_s;
  // One cycle of 1 revolution/s2, and one reading that is off by one revolution, both scaled down to where
  // the filter begins nothing anew.
  constexpr double kSmall = 1e-3;
  const double accelerated =
      summed_error(
          q, [&](int n) { return n <= 0 ? 0.0 : kSmall * dt * dt * (n - 0.5); }, [](int) { return 0.0; }) /
      kSmall;
  const double misread = summed_error(
                             q, [](int) { return 0.0; }, [&](int k) { return k == 0 ? kSmall : 0.0; }) /
                         kSmall;
  return std::abs(per_turn) * (q.acceleration * accelerated + q.noise_counts / q.counts * misread);
}

}  // namespace servogate::path
