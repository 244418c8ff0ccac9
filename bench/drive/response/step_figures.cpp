// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/response/step_figures.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::bench {
namespace {

constexpr std::size_t kFewest = 10;

/// Time at which the answer, scaled to a step from 0 to 1, first reaches `level`, between two samples.
std::optional<double> reaches(std::span<const double> actual, double h, double from, double step,
                              double level) {
  double before = 0.0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double now = (actual[i] - from) / step;
    if (now >= level) {
      if (i == 0 || now == before) return static_cast<double>(i) * h;
      return (static_cast<double>(i) - (now - level) / (now - before)) * h;
    }
    before = now;
  }
  return std::nullopt;
}

}  // namespace

std::optional<StepFigures> step_figures(std::span<const double> actual, double h, double from, double to,
                                        double band) {
  const double step = to - from;
  if (actual.size() < kFewest || step == 0.0) return std::nullopt;
  StepFigures f;
  f.dead_s = reaches(actual, h, from, step, 0.05);
  const auto low = reaches(actual, h, from, step, 0.1), high = reaches(actual, h, from, step, 0.9);
  if (low && high) f.rise_s = *high - *low;
  std::size_t outside = 0;  // one behind the last sample outside of the band
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double error = (to - actual[i]) / step;
    f.overshoot = std::max(f.overshoot, -error);
    if (std::abs(error) > band) outside = i + 1;
    f.iae += std::abs(to - actual[i]) * h;
    f.itae += static_cast<double>(i) * h * std::abs(to - actual[i]) * h;
  }
  if (outside < actual.size()) f.settling_s = static_cast<double>(outside) * h;
  const std::size_t last = std::max<std::size_t>(1, actual.size() / 10);
  double sum = 0.0;
  for (const double a : actual.last(last)) sum += a;
  f.steady_error = to - sum / static_cast<double>(last);
  return f;
}

FollowingFigures following_figures(std::span<const double> wanted, std::span<const double> actual, double h) {
  FollowingFigures f;
  const std::size_t n = std::min(wanted.size(), actual.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double error = wanted[i] - actual[i];
    f.greatest = std::max(f.greatest, std::abs(error));
    squares += error * error;
    f.itae += static_cast<double>(i) * h * std::abs(error) * h;
    f.at_end = error;
  }
  if (n > 0) f.root_mean_square = std::sqrt(squares / static_cast<double>(n));
  return f;
}

}  // namespace servogate::bench
