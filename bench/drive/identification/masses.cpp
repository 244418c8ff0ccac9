// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/identification/masses.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kFewest = 6;

/// Logarithms of what is above zero, so that no step of the search leaves it.
enum Parameter : Eigen::Index {
  kMotor,
  kViscous,
  kDelay,
  kRoll,
  kRigid,
  kLoad = kRigid,
  kSpring,
  kDamping,
  kTwo
};

Complex model(const Eigen::VectorXd& p, double hz) {
  const Complex s(0.0, kTurn * hz);
  const double j1 = std::exp(p(kMotor)), b = p(kViscous);
  Complex g;
  if (p.size() == kRigid) {
    g = 1.0 / (j1 * s + b);
  } else {
    const double j2 = std::exp(p(kLoad)), k = std::exp(p(kSpring)), d = std::exp(p(kDamping));
    const Complex spring = d * s + k, load = j2 * s + b;
    // Seen from the motor: its own mass beside the load behind the spring.
    g = 1.0 / (j1 * s + spring * load / (spring + s * load));
  }
  // What a torque held between two samples differs from the one at a sample: a delay and a fall with the
  // square of the frequency.
  return g * std::exp(-s * p(kDelay)) * std::exp(-p(kRoll) * hz * hz * 1e-4);
}

struct Search {
  Eigen::VectorXd p;
  double cost = 1e300;
};

Eigen::VectorXd residuals(const Eigen::VectorXd& p, const std::vector<ResponseLine>& lines) {
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(lines.size()));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Complex ratio = std::log(lines[i].value / model(p, lines[i].hz));
    // A line's noise to signal ratio is (1 - c) / c; below one per cent all count the same.
    const double c = lines[i].coherence, weight = 1.0 / std::sqrt(0.01 + (1.0 - c) / c);
    r(2 * static_cast<Eigen::Index>(i)) = weight * ratio.real();
    r(2 * static_cast<Eigen::Index>(i) + 1) = weight * ratio.imag();
  }
  return r;
}

/// Levenberg-Marquardt with a Jacobian by differences.
Search search(Eigen::VectorXd p, const std::vector<ResponseLine>& lines) {
  constexpr int kRounds = 100;
  Eigen::VectorXd r = residuals(p, lines);
  double cost = r.squaredNorm(), damping = 1e-3;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd jacobian(r.size(), p.size());
    for (Eigen::Index k = 0; k < p.size(); ++k) {
      Eigen::VectorXd q = p;
      const double step = 1e-6 * std::max(k == kViscous || k == kDelay ? 1e-3 : 1.0, std::abs(p(k)));
      q(k) += step;
      jacobian.col(k) = (residuals(q, lines) - r) / step;
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * r;
    bool better = false;
    while (!better && damping < 1e12) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() *= 1.0 + damping;
      damped.diagonal().array() += 1e-300;
      const Eigen::VectorXd next = p - damped.ldlt().solve(gradient);
      const Eigen::VectorXd r_next = residuals(next, lines);
      const double c = r_next.squaredNorm();
      if (std::isfinite(c) && c < cost) {
        const bool done = cost - c < 1e-12 * cost;
        p = next;
        r = r_next;
        cost = c;
        damping = std::max(1e-12, damping / 5.0);
        if (done) return {p, cost};
        better = true;
      } else {
        damping *= 4.0;
      }
    }
    if (!better) break;
  }
  return {p, cost};
}

double misfit_of(const Eigen::VectorXd& p, const std::vector<ResponseLine>& lines) {
  double sum = 0.0;
  for (const ResponseLine& line : lines) sum += std::norm(std::log(line.value / model(p, line.hz)));
  return std::sqrt(sum / static_cast<double>(lines.size()));
}

/// Mean of 1 / (w |H|) of lines below `hz`: of a mass that is still one.
double inertia_below(const std::vector<ResponseLine>& lines, double hz) {
  double sum = 0.0;
  int count = 0;
  for (const ResponseLine& line : lines) {
    if (count >= 3 && line.hz > hz) break;
    sum += 1.0 / (kTurn * line.hz * std::abs(line.value));
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

Eigen::VectorXd two_mass_start(const std::vector<ResponseLine>& lines, double dip_hz, double peak_hz) {
  const double total = inertia_below(lines, 0.4 * dip_hz), ratio = std::pow(peak_hz / dip_hz, 2) - 1.0;
  const double motor = total / (1.0 + ratio), load = total - motor, w = kTurn * dip_hz;
  const double stiffness = load * w * w;
  Eigen::VectorXd p = Eigen::VectorXd::Zero(kTwo);
  p(kMotor) = std::log(motor);
  p(kLoad) = std::log(load);
  p(kSpring) = std::log(stiffness);
  p(kDamping) = std::log(0.04 * stiffness / w);
  return p;
}

Coupling coupling_of(const Eigen::VectorXd& p) {
  Coupling c;
  c.motor_inertia_kg_m2 = std::exp(p(kMotor));
  c.load_inertia_kg_m2 = std::exp(p(kLoad));
  c.stiffness_nm_rad = std::exp(p(kSpring));
  c.damping_nm_s = std::exp(p(kDamping));
  c.antiresonance_hz = std::sqrt(c.stiffness_nm_rad / c.load_inertia_kg_m2) / kTurn;
  c.resonance_hz =
      std::sqrt(c.stiffness_nm_rad * (1.0 / c.motor_inertia_kg_m2 + 1.0 / c.load_inertia_kg_m2)) / kTurn;
  return c;
}

}  // namespace

std::optional<Masses> fit_masses(const FrequencyResponse& response) {
  std::vector<ResponseLine> lines;
  for (const ResponseLine& line : response.lines)
    if (std::abs(line.value) > 0.0) lines.push_back(line);
  if (lines.size() < kFewest) return std::nullopt;

  Eigen::VectorXd start = Eigen::VectorXd::Zero(kRigid);
  start(kMotor) = std::log(inertia_below(lines, lines[lines.size() / 3].hz));
  const Search rigid = search(start, lines);

  Search two;
  const std::vector<Extreme> found = extremes(response);
  for (std::size_t i = 0; i + 1 < found.size(); ++i)
    if (!found[i].peak && found[i + 1].peak) {
      Search s = search(two_mass_start(lines, found[i].hz, found[i + 1].hz), lines);
      if (s.cost < two.cost) two = std::move(s);
    }
  Masses out;
  // Three parameters more have to explain much more.
  const bool coupled = two.cost < 0.25 * rigid.cost;
  const Eigen::VectorXd& p = coupled ? two.p : rigid.p;
  out.inertia_kg_m2 = std::exp(p(kMotor));
  out.viscous_nm_s = p(kViscous);
  out.delay_s = p(kDelay);
  out.misfit = misfit_of(p, lines);
  if (coupled) {
    out.coupling = coupling_of(p);
    out.inertia_kg_m2 += out.coupling->load_inertia_kg_m2;
  }
  return out;
}

Complex response_of(const Masses& m, double hz) noexcept {
  const Complex s(0.0, kTurn * hz);
  if (!m.coupling) return std::exp(-s * m.delay_s) / (m.inertia_kg_m2 * s + m.viscous_nm_s);
  const Coupling& c = *m.coupling;
  const Complex spring = c.damping_nm_s * s + c.stiffness_nm_rad;
  const Complex load = c.load_inertia_kg_m2 * s + m.viscous_nm_s;
  return std::exp(-s * m.delay_s) / (c.motor_inertia_kg_m2 * s + spring * load / (spring + s * load));
}

std::optional<double> delay_of(const FrequencyResponse& response) {
  if (response.lines.size() < 2) return std::nullopt;
  double phase = std::arg(response.lines.front().value), sum_wp = 0.0, sum_ww = 0.0;
  for (const ResponseLine& line : response.lines) {
    const double now = std::arg(line.value);
    phase = now - kTurn * std::round((now - phase) / kTurn);
    const double w = kTurn * line.hz;
    sum_wp += w * phase;
    sum_ww += w * w;
  }
  return -sum_wp / sum_ww;
}

}  // namespace servogate::bench
