// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/s_curve.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

/// Distances closer than this count as equal; a set-point moves by it unseen (a tenth of a picometre in mm is
/// 1e-10).
constexpr double kSame = 1e-10;

/// The fastest change of speed: jerk up to `peak`, hold, jerk back to 0.
struct Ramp {
  double jerk_in, t_in, t_hold, t_out, peak;
};

Ramp ramp(double v0, double a0, double v1, const Box& box) {
  const double j = box.jerk, natural = v0 + 0.5 * a0 * std::abs(a0) / j;
  const double sign = v1 >= natural ? 1.0 : -1.0;
  const double a = sign * a0, rise = sign * (v1 - v0);
  double peak = std::sqrt(std::max(0.0, j * rise + 0.5 * a * a));
  peak = std::max(peak, a);
  double hold = 0.0;
  if (peak > box.acceleration) {
    peak = std::max(box.acceleration, a);
    hold = std::max(0.0, (rise - (2.0 * peak * peak - a * a) / (2.0 * j)) / peak);
  }
  return {sign * j, (peak - a) / j, hold, peak / j, sign * peak};
}

/// The x between `low` and `high` (either order) nearest to high with distance(x) <= length, which holds at
/// low: Illinois' rule, halving where that is slow, so that sixty rounds are enough for any bracket.
template <typename F>
double solve(double low, double high, double length, F distance) {
  double f_low = distance(low) - length, f_high = distance(high) - length, missing = -f_low;
  if (f_high <= 0.0) return high;
  const double close = 1e-13 * length + 1e-14;
  double width = std::abs(high - low);
  int side = 0;
  for (int round = 0; round < 60 && missing > close; ++round) {
    if (std::abs(high - low) <= 1e-15 * (std::abs(high) + std::abs(low))) break;
    double x = (low * f_high - high * f_low) / (f_high - f_low);
    const bool slow = round % 3 == 2 && std::abs(high - low) > 0.25 * width;
    if (round % 3 == 2) width = std::abs(high - low);
    if (slow || !(x > std::min(low, high) && x < std::max(low, high))) x = 0.5 * (low + high);
    const double f = distance(x) - length;
    if (f <= 0.0) {
      low = x;
      f_low = f;
      missing = -f;
      if (side == -1) f_high *= 0.5;
      side = -1;
    } else {
      high = x;
      f_high = f;
      if (side == 1) f_low *= 0.5;
      side = 1;
    }
  }
  return low;
}

/// Distance of the way to rest without acceleration at its begin.
double way_to_rest(double v, const Box& box) {
  const double a = box.acceleration, j = box.jerk;
  const double time = v * j <= a * a ? 2.0 * std::sqrt(v / j) : v / a + a / j;
  return 0.5 * v * time;
}

void build(Profile& profile, const MotionState& from, double peak, double length, const Box& box) {
  const double d = ramp_distance(from.v, from.a, peak, box) + way_to_rest(peak, box);
  profile.start(from);
  add_ramp(profile, from.v, from.a, peak, box);
  // A rest of rounding errors is no distance to drive: at a peak of rounding errors it would take for ever.
  if (peak > 0.0 && length - d > kSame) profile.add((length - d) / peak, 0.0);
  add_ramp(profile, peak, 0.0, 0.0, box);
  profile.finish_at({from.s + length, 0.0, 0.0});
}

}  // namespace

void Profile::start(const MotionState& state) noexcept {
  count_ = 0;
  duration_ = 0.0;
  end_ = state;
}

void Profile::add(double duration, double jerk) noexcept {
  if (!(duration > 0.0) || count_ == kMaxPhases) return;
  phases_[count_++] = {end_, duration_, jerk};
  duration_ += duration;
  const double t = duration;
  end_ = {end_.s + t * (end_.v + t * (0.5 * end_.a + t * jerk / 6.0)), end_.v + t * (end_.a + 0.5 * t * jerk),
          end_.a + t * jerk};
}

MotionState Profile::at(double t) const noexcept {
  if (t >= duration_ || count_ == 0) return end_;
  const Phase& p = phases_[phase(t)];
  const MotionState& f = p.from;
  const double u = t - p.begins;
  return {f.s + u * (f.v + u * (0.5 * f.a + u * p.jerk / 6.0)), f.v + u * (f.a + 0.5 * u * p.jerk),
          f.a + u * p.jerk};
}

double ramp_distance(double v0, double a0, double v1, const Box& box) noexcept {
  const Ramp r = ramp(v0, a0, v1, box);
  const double j = r.jerk_in, t1 = r.t_in, t2 = r.t_hold, t3 = r.t_out;
  const double d1 = t1 * (v0 + t1 * (0.5 * a0 + t1 * j / 6.0)), w1 = v0 + t1 * (a0 + 0.5 * t1 * j);
  const double d2 = t2 * (w1 + 0.5 * t2 * r.peak);
  // The last phase read backwards from (v1, 0).
  const double d3 = t3 * (v1 - t3 * t3 * j / 6.0);
  return d1 + d2 + d3;
}

void add_ramp(Profile& profile, double v0, double a0, double v1, const Box& box) noexcept {
  const Ramp r = ramp(v0, a0, v1, box);
  profile.add(r.t_in, r.jerk_in);
  profile.add(r.t_hold, 0.0);
  profile.add(r.t_out, -r.jerk_in);
  profile.finish_at({profile.end().s, v1, 0.0});
}

double reachable_speed(double length, const Box& box) noexcept {
  const double a = box.acceleration, j = box.jerk, b = a * a / j;
  // Up to a^2 / j the acceleration limit is not met: j x^3 = length with x = sqrt(v / j).
  if (b * a / j >= length) {
    const double x = std::cbrt(length / j);
    return j * x * x;
  }
  // v / 2 * (v / a + a / j) = length.
  return 0.5 * (-b + std::sqrt(b * b + 8.0 * a * length));
}

bool plan(Profile& profile, const MotionState& from, const Goal& goal, const Box& box) noexcept {
  const double length = goal.length;
  const auto reach = [&](double v) { return ramp_distance(from.v, from.a, v, box); };
  const double rests = reach(0.0);
  if (rests > length + kSame) return false;
  if (goal.velocity <= 0.0) {
    profile.start(from);
    add_ramp(profile, from.v, from.a, 0.0, box);
    profile.finish_at({from.s + std::min(rests, length), 0.0, 0.0});
    return true;
  }
  const auto whole = [&](double peak) { return reach(peak) + way_to_rest(peak, box); };
  const double natural = std::max(0.0, from.v + 0.5 * from.a * std::abs(from.a) / box.jerk);
  const double low = goal.velocity >= natural && whole(natural) <= length ? natural : 0.0;
  // Nothing faster than this can slow down to rest within the length.
  double high = std::min(goal.velocity, std::max(low, reachable_speed(length, box)));
  if (low < natural && high > natural) high = natural;
  const double peak = high <= low ? low : solve(low, high, length, whole);
  build(profile, from, peak, length, box);
  return true;
}

}  // namespace servogate::path
