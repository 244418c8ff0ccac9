// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/relay.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRamp_s = 0.25;
/// Hysteresis against what the speed scatters by itself.
constexpr double kScatters = 4.0;

struct Steady {
  double torque = 0.0, scatter = 0.0;  ///< mean torque, standard deviation of the speed
};

std::optional<Steady> look_at_steady(Guard& guard, const RelayPlan& plan) {
  if (!guard.run_at(plan.speed_rad_s, std::abs(plan.speed_rad_s) / kRamp_s, 0.5 * plan.hold_s))
    return std::nullopt;
  double n = 0.0, torque = 0.0, speed = 0.0, squares = 0.0;
  for (double t = 0.0; t < plan.hold_s; t += guard.period_s(), n += 1.0) {
    if (!guard.step(Loop::velocity, plan.speed_rad_s)) return std::nullopt;
    torque += guard.answer().torque_nm;
    speed += guard.speed_rad_s();
    squares += guard.speed_rad_s() * guard.speed_rad_s();
  }
  const double mean = speed / n;
  return Steady{torque / n, std::sqrt(std::max(0.0, squares / n - mean * mean))};
}

/// Samples at which the relay switched up.
std::optional<std::vector<std::size_t>> swing(Guard& guard, const RelayPlan& plan, const Steady& steady) {
  const std::size_t wanted = static_cast<std::size_t>(plan.periods + plan.periods / 4 + 1);
  std::vector<std::size_t> ups;
  bool up = true;
  for (double t = 0.0; t < plan.most_s && ups.size() < wanted; t += guard.period_s()) {
    const double error = plan.speed_rad_s - guard.speed_rad_s(), edge = kScatters * steady.scatter;
    const bool before = up;
    up = up ? error > -edge : error > edge;
    if (up && !before) ups.push_back(guard.samples().size());
    const double torque = steady.torque + (up ? plan.torque_nm : -plan.torque_nm);
    const double most = guard.envelope().torque_nm;
    if (!guard.step(Loop::torque, std::clamp(torque, -most, most))) return std::nullopt;
  }
  if (ups.size() < wanted) return std::nullopt;
  ups.erase(ups.begin(), ups.begin() + plan.periods / 4);
  return ups;
}

/// The part of a course at one frequency, by a Hann window, which needs no whole periods.
Complex part_at(const std::vector<double>& values, double hz, double period) {
  double mean = 0.0;
  for (const double v : values) mean += v;
  mean /= static_cast<double>(values.size());
  Complex sum;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(values.size());
    sum += (values[i] - mean) * (1.0 - std::cos(kTurn * at)) *
           std::polar(1.0, -kTurn * hz * static_cast<double>(i) * period);
  }
  return 2.0 * sum / static_cast<double>(values.size());
}

}  // namespace

std::vector<double> relay_course(const RelayPlan& plan, double period) {
  const double seconds = kRamp_s + 1.5 * plan.hold_s + plan.most_s;
  return std::vector<double>(static_cast<std::size_t>(seconds / period) + 1, plan.speed_rad_s);
}

std::optional<RelayResponse> take_relay(Guard& guard, const RelayPlan& plan) {
  guard.stage("relay");
  const double h = guard.period_s();
  const auto steady = look_at_steady(guard, plan);
  if (!steady) return std::nullopt;
  const auto ups = swing(guard, plan, *steady);
  if (!ups) return std::nullopt;
  const std::size_t first = ups->front(), last = ups->back();
  RelayResponse out;
  out.hz = static_cast<double>(plan.periods) / (static_cast<double>(last - first) * h);
  std::vector<double> angle, torque;
  for (std::size_t i = first; i < last && i < guard.samples().size(); ++i) {
    angle.push_back(guard.samples()[i].position_rad);
    torque.push_back(guard.samples()[i].torque_nm);
  }
  const std::vector<double> speed = slope(angle, h);  // value i is of sample i + 1
  if (speed.size() < 16) return std::nullopt;
  torque.erase(torque.begin());
  torque.pop_back();
  const Complex v = part_at(speed, out.hz, h) / slope_gain(out.hz, h), t = part_at(torque, out.hz, h);
  // A torque that swings by less than half of what was asked for is not what makes the speed swing.
  if (std::abs(t) < 0.5 * plan.torque_nm || !(std::abs(v) > 0.0)) return std::nullopt;
  out.swing_rad_s = std::abs(v);
  out.inertia_kg_m2 = std::abs(t) / (kTurn * out.hz * out.swing_rad_s);
  const double edge = std::min(1.0, kScatters * steady->scatter / out.swing_rad_s);
  out.dead_time_s = (0.25 * kTurn - std::asin(edge)) / (kTurn * out.hz);
  return out;
}

FrequencyResponse relay_model(const RelayResponse& response, double from_hz, double to_hz) {
  FrequencyResponse out;
  for (double hz = from_hz; hz <= to_hz; hz += 1.0)
    out.lines.push_back({hz, 1.0 / Complex(0.0, kTurn * hz * response.inertia_kg_m2), 1.0});
  if (out.lines.empty()) return out;
  out.valid_from_hz = out.lines.front().hz;
  out.valid_to_hz = out.lines.back().hz;
  return out;
}

}  // namespace servogate::bench
