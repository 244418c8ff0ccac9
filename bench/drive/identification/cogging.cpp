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

/// Harmonic of the torque over the even angle: torque = Re(x exp(i periods angle)) beside a straight line.
Complex harmonic(const EvenRun& run, const Line& even, int periods) {
  const std::size_t n = run.angle_rad.size();
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n) - 0.5;
    const double phase = periods * (even.offset + even.rate * static_cast<double>(i));
    const Eigen::Vector4d row(1.0, t, std::cos(phase), std::sin(phase));
    normal += row * row.transpose();
    right += row * run.torque_nm[i];
  }
  const Eigen::Vector4d x = normal.ldlt().solve(right);
  return {x(2), -x(3)};
}

/// Mean over the runs that are slow enough for it.
Complex mean_harmonic(std::span<const EvenRun> runs, std::span<const Line> lines, int periods) {
  Complex sum;
  double count = 0.0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (std::abs(periods * lines[i].rate) > kFastest) continue;
    sum += harmonic(runs[i], lines[i], periods);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : Complex(0.0);
}

/// Values about a sample, weighted by a triangle of +-n samples: what a second difference over n samples is
/// of the acceleration.
double smoothed(std::size_t i, std::size_t n, auto value) {
  double sum = 0.0;
  for (std::size_t k = 0; k <= 2 * n; ++k) {
    const double weight = static_cast<double>(std::min(k, 2 * n - k));
    if (weight > 0.0) sum += weight * value(i + k - n);
  }
  return sum / static_cast<double>(n * n);
}

/// Sums of runs for the least squares of three columns, each without its mean: sine, cosine, and how fast the
/// torque falls, whose factor is the time by which it is measured after the angle.
class CoggingSums {
 public:
  void add(const EvenRun& run, const Masses& masses, const FrictionCurve& friction, int periods) {
    const std::size_t n = std::max<std::size_t>(2, static_cast<std::size_t>(kSmooth_s / run.period_s)),
                      count = run.angle_rad.size();
    if (count < 4 * n) return;
    const auto& a = run.angle_rad;
    const double h = static_cast<double>(n) * run.period_s;
    const double mean_speed = (a.back() - a.front()) / (static_cast<double>(count - 1) * run.period_s);
    const double w = std::abs(mean_speed) * periods;
    const double slope =
        (friction.at(1.02 * mean_speed) - friction.at(0.98 * mean_speed)) / (0.04 * mean_speed);
    const Complex follows = load_by_motor(masses, slope, w);
    const double load = masses.coupling ? masses.coupling->load_inertia_kg_m2 : 0.0;
    const double motor = masses.inertia_kg_m2 - load;
    Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    double rows = 0.0;
    for (std::size_t i = n; i + n < count; ++i) {
      const double speed = (a[i + n] - a[i - n]) / (2.0 * h);
      // Where it almost stands nobody knows what friction does.
      if (speed / mean_speed < kMoves) continue;
      const double acceleration = (a[i + n] - 2.0 * a[i] + a[i - n]) / (h * h);
      // What leads or lags is the derivative or the integral of what swings.
      const double off = speed - mean_speed;
      const double load_accelerates = follows.real() * acceleration - follows.imag() * w * off;
      const double load_speed = mean_speed + follows.real() * off + follows.imag() * acceleration / w;
      const double takes = motor * acceleration + load * load_accelerates + friction.at(load_speed);
      const double torque = smoothed(i, n, [&](std::size_t k) { return run.torque_nm[k]; });
      double rises = 0.0;
      for (std::size_t k = 0; k < n; ++k) rises += run.torque_nm[i + 1 + k] - run.torque_nm[i - 1 - k];
      const Eigen::Vector4d row(smoothed(i, n, [&](std::size_t k) { return std::sin(periods * a[k]); }),
                                smoothed(i, n, [&](std::size_t k) { return std::cos(periods * a[k]); }),
                                -rises / (static_cast<double>(n) * h), torque - takes);
      squares += row * row.transpose();
      mean += row;
      rows += 1.0;
    }
    if (rows < 3.0) return;
    runs_.push_back({squares - mean * mean.transpose() / rows, rows});
    turns_ += std::abs(a.back() - a.front()) / kTurn;
  }
  double turns() const noexcept { return turns_; }
  /// Of the three columns. A run counts by what it leaves: a load that chatters on its friction leaves much.
  Eigen::Vector3d solve() const {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (int round = 0; round < 4; ++round) {
      Eigen::Matrix4d all = Eigen::Matrix4d::Zero();
      for (const Run& run : runs_) all += run.squares / (round == 0 ? 1.0 : left(run, x));
      x = all.topLeftCorner<3, 3>().ldlt().solve(all.topRightCorner<3, 1>());
    }
    return x;
  }

 private:
  static constexpr double kSmooth_s = 0.008, kMoves = 0.25;
  /// How the load swings when the motor swings by one: further than that below its antiresonance.
  static Complex load_by_motor(const Masses& masses, double friction_slope, double w) {
    if (!masses.coupling) return 1.0;
    const Coupling& c = *masses.coupling;
    const Complex spring(c.stiffness_nm_rad, w * c.damping_nm_s);
    return spring / (spring + Complex(-c.load_inertia_kg_m2 * w * w, w * friction_slope));
  }
  struct Run {
    Eigen::Matrix4d squares;
    double rows = 0.0;
  };
  /// Mean square of what is left of a run.
  static double left(const Run& run, const Eigen::Vector3d& x) {
    const Eigen::Vector4d one(x(0), x(1), x(2), -1.0);
    return std::max(1e-18, one.dot(run.squares * one) / run.rows);
  }
  std::vector<Run> runs_;
  double turns_ = 0.0;
};

}  // namespace

double Cogging::at(double angle) const noexcept {
  return amplitude_nm * std::sin(periods * angle + phase_rad);
}

std::optional<Cogging> find_cogging(std::span<const EvenRun> runs, int most_periods) {
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
  // The torque of the speed loop works against it.
  std::vector<double> sizes(most);
  for (std::size_t i = 0; i < most; ++i)
    sizes[i] = std::abs(mean_harmonic(runs, lines, static_cast<int>(i) + 1));
  const auto best = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin()) + 1;
  const double strongest = sizes[static_cast<std::size_t>(best) - 1];
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(most / 2), sizes.end());
  if (strongest < 5.0 * sizes[most / 2]) return std::nullopt;
  // Re(c exp(i p a)) = |c| cos(p a + arg c) = |c| sin(p a + arg c + 90 degrees).
  const double phase = std::arg(mean_harmonic(runs, lines, best)) + 0.25 * kTurn;
  return Cogging{strongest, best, std::remainder(phase, kTurn)};
}

std::optional<Cogging> size_cogging(std::span<const EvenRun> runs, const Masses& masses,
                                    const FrictionCurve& friction, int periods) {
  CoggingSums sums;
  for (const EvenRun& run : runs) sums.add(run, masses, friction, periods);
  if (sums.turns() * periods < 3.0) return std::nullopt;
  const Eigen::Vector3d x = sums.solve();
  return Cogging{std::hypot(x(0), x(1)), periods, std::atan2(x(1), x(0))};
}

}  // namespace servogate::bench
