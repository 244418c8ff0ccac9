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

/// Least squares for harmonics over an angle: a series is Re(x exp(i periods angle)) beside a straight line.
class Projection {
 public:
  Projection(std::size_t count, int periods, auto angle) : rows_(count) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(count) - 0.5, phase = periods * angle(i);
      rows_[i] = {1.0, t, std::cos(phase), std::sin(phase)};
      normal += rows_[i] * rows_[i].transpose();
    }
    solver_.compute(normal);
  }
  double count() const noexcept { return static_cast<double>(rows_.size()); }
  /// `left`: mean square of what the harmonic and the line leave.
  Complex of(auto value, double* left = nullptr) const {
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double squares = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double v = value(i);
      right += rows_[i] * v;
      squares += v * v;
    }
    const Eigen::Vector4d x = solver_.solve(right);
    if (left != nullptr) *left = std::max(0.0, squares - x.dot(right)) / count();
    return {x(2), -x(3)};
  }

 private:
  std::vector<Eigen::Vector4d> rows_;
  Eigen::LDLT<Eigen::Matrix4d> solver_;
};

/// What motion takes of the torque at a harmonic, by the acceleration of the motor.
Complex inertia_at(const Masses& masses, double friction_slope, double w) {
  const Complex s(0.0, w);
  if (!masses.coupling) return masses.inertia_kg_m2 + friction_slope / s;
  const Coupling& c = *masses.coupling;
  const Complex spring = c.stiffness_nm_rad + c.damping_nm_s * s;
  const Complex load = c.load_inertia_kg_m2 * s + friction_slope;  // torque by speed
  return c.motor_inertia_kg_m2 + spring * load / (spring + load * s) / s;
}

/// The harmonic of one run over the angle that was, however uneven its speed.
struct RunHarmonic {
  Complex torque, motion;  ///< measured, and what the motion takes of it
  double w = 0.0;          ///< rad/s, below 0: backwards
  double deviation = 0.0;  ///< of their difference
};

std::optional<RunHarmonic> harmonic_of(const EvenRun& run, const Masses& masses,
                                       const FrictionCurve& friction, int periods) {
  constexpr double kLag = 0.12, kLongestLag_s = 0.008;  // of the second difference: so much of a period
  constexpr double kModel = 0.005;                      // share by which the motion is off beside its inertia
  const auto& a = run.angle_rad;
  const std::size_t count = a.size();
  if (count < 16 || run.torque_nm.size() != count) return std::nullopt;
  const double speed = (a.back() - a.front()) / (static_cast<double>(count - 1) * run.period_s);
  const double w = std::abs(speed) * periods;
  if (w * static_cast<double>(count) * run.period_s < kTurn || w * run.period_s > kFastest)
    return std::nullopt;
  const auto lag =
      static_cast<std::size_t>(std::max(1.0, std::min(kLag * kTurn / w, kLongestLag_s) / run.period_s));
  if (count < 8 * lag) return std::nullopt;
  const double h = static_cast<double>(lag) * run.period_s;
  const double seen = std::pow(std::sin(0.5 * w * h) / (0.5 * w * h), 2);  // by a second difference
  const Projection harmonic(count - 2 * lag, periods, [&](std::size_t i) { return a[i + lag]; });
  RunHarmonic out;
  double left = 0.0;
  out.torque = harmonic.of([&](std::size_t i) { return run.torque_nm[i + lag]; }, &left);
  const Complex acceleration =
      harmonic.of([&](std::size_t i) { return (a[i + 2 * lag] - 2.0 * a[i + lag] + a[i]) / (h * h * seen); });
  const double slope = (friction.at(1.02 * speed) - friction.at(0.98 * speed)) / (0.04 * speed);
  out.w = std::copysign(w, speed);
  out.motion = inertia_at(masses, slope, out.w) * acceleration;
  out.deviation =
      std::sqrt(2.0 * left / harmonic.count() + std::pow(kModel * std::abs(out.motion), 2) + 1e-18);
  return out;
}

struct SizeFit {
  Complex size;
  double cost = 0.0;
};

/// For a torque that is measured so much after the angle. The inertia of the motor may be a little off, in
/// all runs alike.
SizeFit fit_size(std::span<const RunHarmonic> runs, double delay_s) {
  constexpr double kInertiaOff = 0.02, kDelay_s = 1e-3;  // what is likely; runs that tell count more
  Eigen::Matrix4d all = Eigen::Matrix4d::Zero();
  all(2, 2) = 1.0 / (kInertiaOff * kInertiaOff);
  for (const RunHarmonic& r : runs) {
    const Complex t = r.torque * std::polar(1.0, r.w * delay_s) - r.motion;
    const Eigen::Vector4d re(1.0, 0.0, r.motion.real(), t.real()), im(0.0, 1.0, r.motion.imag(), t.imag());
    all += (re * re.transpose() + im * im.transpose()) / (r.deviation * r.deviation);
  }
  const Eigen::Vector3d right = all.topRightCorner<3, 1>(), x = all.topLeftCorner<3, 3>().ldlt().solve(right);
  return {{x(0), x(1)}, all(3, 3) - x.dot(right) + std::pow(delay_s / kDelay_s, 2)};
}

Cogging cogging_of(Complex size, int periods) {
  // Re(c exp(i p a)) = |c| cos(p a + arg c) = |c| sin(p a + arg c + 90 degrees).
  return {std::abs(size), periods, std::remainder(std::arg(size) + 0.25 * kTurn, kTurn)};
}

/// What runs say for a harmonic. Each counts by the logarithm of how far it stands out: one run that swings
/// at some frequency of its own does not outvote the others, and phases that differ do not cancel.
struct Evidence {
  double logarithms = 0.0, runs = 0.0;
  Complex sum;
  /// Above 0: more than noise brings. Noise has 0.7 a run, with a deviation of 0.5.
  double surplus() const noexcept { return logarithms - 1.5 * runs; }
};
/// One run with five times the amplitude of the others has it.
constexpr double kStandsOut = 1.75;

void add_evidence(const EvenRun& run, const Line& even, std::vector<Evidence>& evidence) {
  const auto most = std::min(evidence.size(), static_cast<std::size_t>(kFastest / std::abs(even.rate)));
  std::vector<Complex> harmonics;
  std::vector<double> squares;
  for (std::size_t p = 1; p <= most; ++p) {
    const Projection harmonic(run.angle_rad.size(), static_cast<int>(p), [&](std::size_t i) {
      return even.offset + even.rate * static_cast<double>(i);
    });
    harmonics.push_back(harmonic.of([&](std::size_t i) { return run.torque_nm[i]; }));
    squares.push_back(std::norm(harmonics.back()));
  }
  if (most < 3) return;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(most / 2), squares.end());
  const double middle = std::max(1e-30, squares[most / 2]);
  for (std::size_t p = 0; p < most; ++p) {
    evidence[p].logarithms += std::log1p(std::norm(harmonics[p]) / middle);
    evidence[p].runs += 1.0;
    evidence[p].sum += harmonics[p];
  }
}

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
  std::vector<Evidence> evidence(most);
  for (std::size_t k = 0; k < runs.size(); ++k) add_evidence(runs[k], lines[k], evidence);
  const auto best = std::max_element(evidence.begin(), evidence.end(),
                                     [](const auto& a, const auto& b) { return a.surplus() < b.surplus(); });
  if (best->surplus() < kStandsOut) return std::nullopt;
  return cogging_of(best->sum / best->runs, static_cast<int>(best - evidence.begin()) + 1);
}

std::optional<Cogging> size_cogging(std::span<const EvenRun> runs, const Masses& masses,
                                    const FrictionCurve& friction, int periods) {
  constexpr double kEarliest_s = -1e-3, kLatest_s = 3e-3, kStep_s = 1e-5;
  std::vector<RunHarmonic> harmonics;
  double turns = 0.0;
  for (const EvenRun& run : runs)
    if (const auto h = harmonic_of(run, masses, friction, periods)) {
      harmonics.push_back(*h);
      turns += std::abs(run.angle_rad.back() - run.angle_rad.front()) / kTurn;
    }
  if (turns * periods < 3.0) return std::nullopt;
  SizeFit best = fit_size(harmonics, 0.0);
  for (double delay = kEarliest_s; delay <= kLatest_s; delay += kStep_s)
    if (const SizeFit fit = fit_size(harmonics, delay); fit.cost < best.cost) best = fit;
  return cogging_of(best.size, periods);
}

}  // namespace servogate::bench
