// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>

#include "kernel/path/law/master.hpp"

namespace servogate::path::test {

/// A spindle with an encoder: a motor that holds its speed by a limited torque against an inertia and loads
/// that come and go, read through rounding, noise and a bus that is late.
struct TurningSpindle {
  double wanted = 10.0;     ///< revolutions/s
  double ordered = 10.0;    ///< what it is said to be told
  double motor = 40.0;      ///< the most that its motor accelerates it, revolutions/s2
  double stiffness = 40.0;  ///< 1/s: how it goes back to its speed
  double counts = 4096.0;
  double noise = 0.0;     ///< counts, the most, besides rounding
  double dead_s = 0.001;  ///< a reading is so old
  double period_s = 0.001;
  std::function<double(double)> load = [](double) { return 0.0; };  ///< revolutions/s2 at a time
  bool readable = true;

  double n = 0.3137, w = 10.0;     ///< true revolutions and speed
  double most_acceleration = 0.0;  ///< so far
  std::int64_t cycle = 0;
  std::mt19937_64 random{1};

  std::int64_t period_ns() const { return std::llround(period_s * 1e9); }
  void step() {
    constexpr int kSteps = 20;
    const double h = period_s / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const double t = (static_cast<double>(cycle) + static_cast<double>(k) / kSteps) * period_s;
      const double a = std::clamp((wanted - w) * stiffness, -motor, motor) - load(t);
      n += h * (w + 0.5 * h * a);
      w += h * a;
      most_acceleration = std::max(most_acceleration, std::abs(a));
      past.push_front(n);
    }
    while (past.size() > 20 * 200) past.pop_back();
    ++cycle;
  }
  /// In the cycle at hand; its set-point is where the axes are one cycle later.
  MasterReading reading() {
    MasterReading r;
    const auto ago = static_cast<std::size_t>(std::llround(dead_s / period_s * 20.0));
    const double then = ago < past.size() ? past[ago] : n;
    double read = then * counts;
    if (noise > 0.0) read += std::uniform_real_distribution<>(-noise, noise)(random);
    const double whole = std::floor(read) / counts;
    r.valid = readable && ago < past.size();
    r.turns = static_cast<std::int64_t>(std::floor(whole));
    r.part = whole - std::floor(whole);
    r.at_ns = cycle * period_ns() - std::llround(dead_s * 1e9);
    r.acts_ns = (cycle + 1) * period_ns();
    r.braking = motor;
    r.ordered = ordered;
    return r;
  }
  MasterQuality quality() const {
    return {period_s, dead_s + period_s, counts, 1.0 + noise, most_acceleration};
  }
  std::deque<double> past;
};

}  // namespace servogate::path::test
