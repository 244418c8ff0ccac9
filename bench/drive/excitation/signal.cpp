// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/excitation/signal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kMost = 10'000'000;

constexpr std::pair<SignalKind, std::string_view> kNames[] = {
    {SignalKind::step, "step"},           {SignalKind::ramp, "ramp"}, {SignalKind::trapezoid, "trapezoid"},
    {SignalKind::jerk_limited, "jerk"},   {SignalKind::sine, "sine"}, {SignalKind::chirp, "chirp"},
    {SignalKind::multisine, "multisine"}, {SignalKind::prbs, "prbs"},
};

std::vector<double> over_time(const Signal& s, double h, auto value) {
  const double count = std::ceil(s.duration_s / h);
  if (!(count >= 1.0 && count <= static_cast<double>(kMost))) return {};
  std::vector<double> out(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = value(static_cast<double>(i) * h);
  return out;
}

std::vector<double> repeated(const std::vector<double>& once, int periods) {
  std::vector<double> out;
  out.reserve(once.size() * static_cast<std::size_t>(std::max(1, periods)));
  for (int p = 0; p < std::max(1, periods); ++p) out.insert(out.end(), once.begin(), once.end());
  return out;
}

std::vector<double> chirp(const Signal& s, double h) {
  if (!(s.from_hz > 0.0 && s.to_hz > s.from_hz)) return {};
  const double rate = std::log(s.to_hz / s.from_hz) / s.duration_s;
  return over_time(s, h, [&](double t) {
    return s.amplitude * std::sin(kTurn * s.from_hz * std::expm1(rate * t) / rate);
  });
}

std::vector<double> multisine(const Signal& s, double h) {
  const auto n = static_cast<double>(s.period);
  const double line_hz = 1.0 / (n * h);
  const auto first = static_cast<std::size_t>(std::max(1.0, std::ceil(s.from_hz / line_hz - 1e-9)));
  const auto last = static_cast<std::size_t>(std::floor(std::min(s.to_hz / line_hz + 1e-9, 0.5 * n - 1.0)));
  if (s.period < 4 || s.period > kMost || last < first) return {};
  std::mt19937_64 random(s.seed);
  std::vector<double> once(s.period, 0.0);
  for (std::size_t line = first; line <= last; ++line) {
    const double place = static_cast<double>(line - first), count = static_cast<double>(last - first + 1);
    const double phase = s.seed == 0 ? -0.5 * kTurn * place * (place + 1.0) / count
                                     : kTurn * static_cast<double>(random() >> 11) * 0x1p-53;
    for (std::size_t i = 0; i < s.period; ++i)
      once[i] += std::sin(kTurn * static_cast<double>(line * i % s.period) / n + phase);
  }
  const double scale = s.amplitude * std::sqrt(2.0 / static_cast<double>(last - first + 1));
  for (double& v : once) v *= scale;
  return repeated(once, s.periods);
}

/// Feedback taps of shift registers of the longest period, by order; a test walks through each.
constexpr std::uint32_t kTaps[] = {0,     0,     0x3,   0x6,   0xC,    0x14,   0x30,   0x60,   0xB8,
                                   0x110, 0x240, 0x500, 0xE08, 0x1C80, 0x3802, 0x6000, 0xD008, 0x12000};

std::vector<double> prbs(const Signal& s, double h) {
  // An element lasts so long that its spectrum is even up to to_hz: 0.44 of its rate falls by 3 dB.
  const double held = std::max(1.0, std::floor(0.44 / (s.to_hz * h) + 1e-9));
  if (!(s.to_hz > 0.0) || held > 1e6) return {};
  std::size_t order = 2;
  while (order + 1 < std::size(kTaps) &&
         static_cast<double>((std::size_t{1} << order) - 1) * held < static_cast<double>(s.period))
    ++order;
  const auto hold = static_cast<std::size_t>(held);
  const std::size_t length = (std::size_t{1} << order) - 1;
  if (length * hold > kMost) return {};
  auto state = static_cast<std::uint32_t>(1 + s.seed % length);
  std::vector<double> once;
  once.reserve(length * hold);
  for (std::size_t i = 0; i < length; ++i) {
    once.insert(once.end(), hold, (state & 1u) != 0 ? s.amplitude : -s.amplitude);
    state = (state >> 1) ^ ((state & 1u) != 0 ? kTaps[order] : 0u);
  }
  return repeated(once, s.periods);
}

}  // namespace

std::string_view signal_name(SignalKind kind) noexcept {
  for (const auto& [k, name] : kNames)
    if (k == kind) return name;
  return {};
}

bool signal_named(std::string_view name, SignalKind& kind) noexcept {
  for (const auto& [k, n] : kNames)
    if (n == name) {
      kind = k;
      return true;
    }
  return false;
}

namespace {

/// A move whose speed is a trapezoid, with the integral of its position.
class Trapezoid {
 public:
  struct Point {
    double integral = 0.0, position = 0.0, velocity = 0.0, acceleration = 0.0;
  };
  Trapezoid(double distance, double ramp, double until_brake) noexcept
      : distance_(distance),
        ramp_(ramp),
        brake_(until_brake),
        speed_(distance / until_brake),
        acceleration_(speed_ / ramp) {}
  Point at(double t) const noexcept {
    const double end = ramp_ + brake_;
    if (t <= 0.0) return {};
    if (t < ramp_) {
      const double v = acceleration_ * t;
      return {v * t * t / 6.0, v * t / 2.0, v, acceleration_};
    }
    if (t < brake_) return {before_brake(t), speed_ * (t - ramp_ / 2.0), speed_, 0.0};
    if (t >= end) return {brake_integral(ramp_, 0.0) + distance_ * (t - end), distance_, 0.0, 0.0};
    const double left = end - t;
    return {brake_integral(t - brake_, left), distance_ - acceleration_ * left * left / 2.0,
            acceleration_ * left, -acceleration_};
  }

 private:
  double before_brake(double t) const noexcept {
    return speed_ * (ramp_ * ramp_ / 6.0 + (t - ramp_) * t / 2.0);
  }
  double brake_integral(double braked, double left) const noexcept {
    return before_brake(brake_) + distance_ * braked -
           acceleration_ * (ramp_ * ramp_ * ramp_ - left * left * left) / 6.0;
  }

  double distance_, ramp_, brake_, speed_, acceleration_;
};

/// Length of the mean that bounds the jerk. Where acceleration turns into deceleration within it, the
/// acceleration changes by twice its limit.
double jerk_mean(double distance, double speed, double acceleration, double jerk) noexcept {
  if (!(jerk > 0.0)) return 0.0;
  const double mean = acceleration / jerk;
  return std::abs(std::abs(distance) / speed - speed / acceleration) < mean ? 2.0 * mean : mean;
}

}  // namespace

// An even speed of length D/v, averaged over v/a and then over the jerk's mean: each bounds one derivative
// more.
double move_time(double distance, double speed, double acceleration, double jerk) noexcept {
  return std::abs(distance) / speed + speed / acceleration + jerk_mean(distance, speed, acceleration, jerk);
}

MovePoint move_at(double distance, double speed, double acceleration, double jerk, double t) noexcept {
  if (distance == 0.0 || t <= 0.0) return {};
  if (t >= move_time(distance, speed, acceleration, jerk)) return {distance, 0.0, 0.0};
  const double even = std::abs(distance) / speed, ramp = speed / acceleration;
  const Trapezoid course(distance, std::min(even, ramp), std::max(even, ramp));
  const Trapezoid::Point now = course.at(t);
  const double mean = jerk_mean(distance, speed, acceleration, jerk);
  if (mean == 0.0) return {now.position, now.velocity, now.acceleration};
  const Trapezoid::Point before = course.at(t - mean);
  return {(now.integral - before.integral) / mean, (now.position - before.position) / mean,
          (now.velocity - before.velocity) / mean};
}

std::vector<double> samples(const Signal& s, double h) {
  const double nyquist = 0.5 / h;
  const bool moves = s.kind == SignalKind::trapezoid || s.kind == SignalKind::jerk_limited;
  const bool waves = s.kind == SignalKind::sine || s.kind == SignalKind::chirp ||
                     s.kind == SignalKind::multisine || s.kind == SignalKind::prbs;
  if (!(h > 0.0) || !(s.duration_s > 0.0) || !std::isfinite(s.amplitude)) return {};
  if (moves && !(s.speed > 0.0 && s.acceleration > 0.0 && s.jerk > 0.0)) return {};
  if (waves && !(s.from_hz > 0.0 && s.from_hz < nyquist)) return {};
  if (waves && s.kind != SignalKind::sine && !(s.to_hz < nyquist)) return {};
  switch (s.kind) {
    case SignalKind::step:
      return over_time(s, h, [&](double) { return s.amplitude; });
    case SignalKind::ramp:
      return over_time(s, h, [&](double t) { return s.amplitude * t / s.duration_s; });
    case SignalKind::trapezoid:
    case SignalKind::jerk_limited: {
      const double jerk = s.kind == SignalKind::jerk_limited ? s.jerk : 0.0;
      return over_time(
          s, h, [&](double t) { return move_at(s.amplitude, s.speed, s.acceleration, jerk, t).position; });
    }
    case SignalKind::sine:
      return over_time(s, h,
                       [&](double t) { return s.amplitude * std::sin(kTurn * s.from_hz * t + s.phase_rad); });
    case SignalKind::chirp:
      return chirp(s, h);
    case SignalKind::multisine:
      return multisine(s, h);
    case SignalKind::prbs:
      return prbs(s, h);
  }
  return {};
}

}  // namespace servogate::bench
