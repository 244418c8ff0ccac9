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

constexpr double kTurn = 2.0 * std::numbers::pi;
/// Beyond a quarter of the sample rate a harmonic has too few samples, rad a sample.
constexpr double kFastest = 0.25 * kTurn;

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

/// Torque that a swing of the angle takes, per rad.
Complex dynamic_stiffness(const Masses& masses, double friction_slope, double w) {
  Masses at_once = masses;
  at_once.delay_s = 0.0;
  at_once.viscous_nm_s = friction_slope;
  const Complex response = response_of(at_once, std::abs(w) / kTurn);
  // Over a falling angle a harmonic is the conjugate one.
  return Complex(0.0, w) / (w > 0.0 ? response : std::conj(response));
}

constexpr double kOfTorque = 0.02, kOfSwing = 0.02;

struct HeldBack {
  Complex mean;
  double spread = 0.0;  ///< of the runs about it, a sum of squares
};

/// Harmonics of one number of periods in all runs, and what cogging holds back in them.
class Harmonics {
 public:
  Harmonics(std::span<const EvenRun> runs, std::span<const Line> lines, int periods, const Masses* masses) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const double w = periods * lines[i].rate / runs[i].period_s;
      if (std::abs(w) * runs[i].period_s > kFastest) continue;
      const Pair h = harmonic(runs[i], lines[i], periods);
      const Complex stiffness =
          masses != nullptr ? dynamic_stiffness(*masses, runs[i].friction_slope, w) : Complex(0.0);
      all_.push_back({h.torque, stiffness * h.angle, w});
    }
  }
  /// Their mean, were the torque measured `skew_s` after the angle. What the swing of the masses takes is
  /// known to a few per cent, so a run counts the less the more that is.
  HeldBack at(double skew_s) const {
    HeldBack out;
    double weights = 0.0;
    const auto value = [&](const One& o) { return o.torque * std::polar(1.0, o.w * skew_s) - o.swing; };
    const auto weight = [](const One& o) {
      return std::norm(o.torque) / (std::norm(kOfTorque * o.torque) + std::norm(kOfSwing * o.swing));
    };
    for (const One& o : all_) {
      out.mean += weight(o) * value(o);
      weights += weight(o);
    }
    out.mean /= weights;
    for (const One& o : all_) out.spread += weight(o) * std::norm(value(o) - out.mean);
    return out;
  }
  /// The skew at which all runs agree best, within a cycle.
  double skew(double period_s) const {
    constexpr int kGrid = 400;
    double best = 0.0, spread = 1e300;
    for (int i = -kGrid; i <= kGrid; ++i) {
      const double s = period_s * i / kGrid, now = at(s).spread;
      if (now < spread) {
        spread = now;
        best = s;
      }
    }
    return best;
  }

 private:
  struct One {
    Complex torque, swing;
    double w = 0.0;
  };
  std::vector<One> all_;
};

}  // namespace

double Cogging::at(double angle) const noexcept {
  return amplitude_nm * std::sin(periods * angle + phase_rad);
}

std::optional<Cogging> fit_cogging(std::span<const EvenRun> runs, const Masses* masses, int most_periods) {
  std::vector<Line> lines;
  auto most = static_cast<std::size_t>(std::max(0, most_periods));
  double slowest = 1e300;  // rad a sample
  for (const EvenRun& run : runs) {
    if (run.angle_rad.size() < 16 || run.angle_rad.size() != run.torque_nm.size()) return std::nullopt;
    lines.push_back(straight(run.angle_rad));
    const double rate = std::abs(lines.back().rate);
    if (rate * static_cast<double>(run.angle_rad.size()) < kTurn) return std::nullopt;
    slowest = std::min(slowest, rate);
  }
  most = std::min(most, static_cast<std::size_t>(kFastest / slowest));
  if (runs.empty() || most < 3) return std::nullopt;
  // Which harmonic it is shows the torque of the speed loop, which works against it; how large it is, the
  // torque that is left once the uneven speed has been paid for.
  std::vector<double> sizes(most);
  for (std::size_t i = 0; i < most; ++i)
    sizes[i] = std::abs(Harmonics(runs, lines, static_cast<int>(i) + 1, nullptr).at(0.0).mean);
  const auto best = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin()) + 1;
  const double strongest = sizes[static_cast<std::size_t>(best) - 1];
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(most / 2), sizes.end());
  if (strongest < 5.0 * sizes[most / 2]) return std::nullopt;
  const Harmonics harmonics(runs, lines, best, masses);
  // One run, or the raw torque alone, cannot tell a skew from the phase of the cogging.
  const double skew = masses != nullptr && runs.size() > 1 ? harmonics.skew(runs.front().period_s) : 0.0;
  const Complex found = harmonics.at(skew).mean;
  // Re(c exp(i p a)) = |c| cos(p a + arg c) = |c| sin(p a + arg c + 90 degrees).
  return Cogging{std::abs(found), best, std::remainder(std::arg(found) + 0.25 * kTurn, kTurn)};
}

}  // namespace servogate::bench
