// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/identification/cogging.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace servogate::bench {
namespace {

using Complex = std::complex<double>;
constexpr double kTurn = 2.0 * std::numbers::pi;

struct Line {
  double offset = 0.0, rate = 0.0;  ///< per sample
};

Line straight(std::span<const double> values) {
  double n = 0.0, st = 0.0, sv = 0.0, stt = 0.0, stv = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto t = static_cast<double>(i);
    n += 1.0;
    st += t;
    sv += values[i];
    stt += t * t;
    stv += t * values[i];
  }
  const double rate = (n * stv - st * sv) / (n * stt - st * st);
  return {(sv - rate * st) / n, rate};
}

/// Harmonic of two courses over the even angle `phase`: value = Re(x exp(i phase)) beside a straight line.
struct Pair {
  Complex torque, angle;
};
Pair harmonic(const EvenRun& run, const Line& even, int periods) {
  const std::size_t n = run.angle_rad.size();
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 2> right = Eigen::Matrix<double, 4, 2>::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n) - 0.5;
    const double nominal = even.offset + even.rate * static_cast<double>(i);
    const Eigen::Vector4d row(1.0, t, std::cos(periods * nominal), std::sin(periods * nominal));
    normal += row * row.transpose();
    right.col(0) += row * run.torque_nm[i];
    right.col(1) += row * (run.angle_rad[i] - nominal);
  }
  const Eigen::Matrix<double, 4, 2> x = normal.ldlt().solve(right);
  return {{x(2, 0), -x(3, 0)}, {x(2, 1), -x(3, 1)}};
}

}  // namespace

double Cogging::at(double angle) const noexcept {
  return amplitude_nm * std::sin(periods * angle + phase_rad);
}

std::optional<Cogging> fit_cogging(const EvenRun& run, double inertia, double slope, int most_periods) {
  const std::size_t n = std::min(run.angle_rad.size(), run.torque_nm.size());
  if (n < 16) return std::nullopt;
  const Line even = straight(run.angle_rad.first(n));
  if (std::abs(even.rate) * static_cast<double>(n) < kTurn) return std::nullopt;
  const double speed = even.rate / run.period_s;
  // Beyond a quarter of the sample rate a harmonic has too few samples.
  const int most =
      std::min(most_periods, static_cast<int>(0.25 * kTurn / std::max(std::abs(even.rate), 1e-12)));
  std::vector<Complex> found;
  for (int p = 1; p <= most; ++p) {
    const Pair h = harmonic(run, even, p);
    const Complex jw(0.0, p * speed);
    found.push_back(h.torque - (inertia * jw + slope) * jw * h.angle);
  }
  if (found.size() < 3) return std::nullopt;
  std::vector<double> sizes;
  for (const Complex& c : found) sizes.push_back(std::abs(c));
  const auto best = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  const double strongest = sizes[static_cast<std::size_t>(best)];
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  if (strongest < 5.0 * sizes[sizes.size() / 2]) return std::nullopt;
  Cogging out;
  out.periods = static_cast<int>(best) + 1;
  out.amplitude_nm = strongest;
  // Re(c exp(i p a)) = |c| cos(p a + arg c) = |c| sin(p a + arg c + 90 degrees).
  out.phase_rad = std::remainder(std::arg(found[static_cast<std::size_t>(best)]) + 0.25 * kTurn, kTurn);
  return out;
}

}  // namespace servogate::bench
