// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/identification/friction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace servogate::bench {
namespace {

struct Fit {
  Eigen::VectorXd x;  ///< load, Coulomb, viscous and, with a bell, Stribeck
  double cost = 0.0;  ///< sum of squares in standard deviations
  double stribeck_deviation = 0.0;
};

double bell(double speed, double width) {
  const double x = speed / width;
  return std::exp(-x * x);
}

Fit fit(std::span<const FrictionPoint> points, double width) {
  const bool with_bell = width > 0.0;
  const auto n = static_cast<Eigen::Index>(points.size());
  const Eigen::Index columns = with_bell ? 4 : 3;
  Eigen::MatrixXd a(n, columns);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FrictionPoint& p = points[static_cast<std::size_t>(i)];
    const double weight = 1.0 / p.deviation_nm, side = std::copysign(1.0, p.speed_rad_s);
    a(i, 0) = weight;
    a(i, 1) = weight * side;
    a(i, 2) = weight * p.speed_rad_s;
    if (with_bell) a(i, 3) = weight * side * bell(p.speed_rad_s, width);
    b(i) = weight * p.torque_nm;
  }
  Fit out;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  out.x = qr.solve(b);
  out.cost = (a * out.x - b).squaredNorm();
  if (with_bell) {
    const Eigen::MatrixXd normal = a.transpose() * a;
    out.stribeck_deviation = std::sqrt(std::max(0.0, normal.ldlt().solve(Eigen::Vector4d::Unit(3))(3)));
  }
  return out;
}

/// The width that explains the points best, between the slowest and the fastest speed.
double best_width(std::span<const FrictionPoint> points) {
  double slowest = 1e300, fastest = 0.0;
  for (const FrictionPoint& p : points) {
    if (std::abs(p.speed_rad_s) <= FrictionPoint::kAtRest) continue;
    slowest = std::min(slowest, std::abs(p.speed_rad_s));
    fastest = std::max(fastest, std::abs(p.speed_rad_s));
  }
  double low = std::log(std::max(slowest, 1e-9)), high = std::log(std::max(fastest, 2e-9) / 2.0);
  if (high <= low) return 0.0;
  constexpr int kGrid = 60;
  double best = low, cost = 1e300;
  for (int i = 0; i <= kGrid; ++i) {
    const double at = low + (high - low) * i / kGrid;
    const double c = fit(points, std::exp(at)).cost;
    if (c < cost) {
      cost = c;
      best = at;
    }
  }
  // Golden section within the neighbours.
  const double step = (high - low) / kGrid, ratio = 0.618033988749895;
  double a = best - step, b = best + step;
  for (int i = 0; i < 40; ++i) {
    const double c = b - ratio * (b - a), d = a + ratio * (b - a);
    if (fit(points, std::exp(c)).cost < fit(points, std::exp(d)).cost)
      b = d;
    else
      a = c;
  }
  return std::exp(0.5 * (a + b));
}

FrictionCurve curve_of(std::span<const FrictionPoint> points) {
  const Fit plain = fit(points, 0.0);
  FrictionCurve curve;
  const double width = points.size() >= 7 ? best_width(points) : 0.0;
  const Fit belled = width > 0.0 ? fit(points, width) : plain;
  const bool shown = width > 0.0 && belled.x(3) > 4.0 * belled.stribeck_deviation;
  const Fit& used = shown ? belled : plain;
  curve.load_nm = used.x(0);
  curve.coulomb_nm = used.x(1);
  curve.viscous_nm_s = used.x(2);
  if (shown) {
    curve.stribeck_nm = belled.x(3);
    curve.stribeck_speed_rad_s = width;
  }
  return curve;
}

/// Points far from the curve that the others make count less: a load that sticks and slips has no friction at
/// its mean speed. Source of the weight: Cauchy's, of iteratively reweighted least squares.
std::vector<FrictionPoint> reweighted(std::span<const FrictionPoint> points, const FrictionCurve& curve) {
  constexpr double kCut = 2.385;
  std::vector<double> off;
  for (const FrictionPoint& p : points)
    off.push_back(std::abs(p.torque_nm - curve.at(p.speed_rad_s)) / p.deviation_nm);
  std::vector<double> sorted = off;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double scale = kCut * std::max(1.0, 1.4826 * *middle);
  std::vector<FrictionPoint> out(points.begin(), points.end());
  for (std::size_t i = 0; i < out.size(); ++i) out[i].deviation_nm *= std::hypot(1.0, off[i] / scale);
  return out;
}

}  // namespace

double FrictionCurve::at(double speed) const noexcept {
  const double extra = stribeck_speed_rad_s > 0.0 ? stribeck_nm * bell(speed, stribeck_speed_rad_s) : 0.0;
  return load_nm + std::copysign(coulomb_nm + extra, speed) + viscous_nm_s * speed;
}

std::optional<FrictionCurve> fit_friction(std::span<const FrictionPoint> points) {
  constexpr int kRounds = 8;
  const auto forward =
      std::count_if(points.begin(), points.end(), [](const auto& p) { return p.speed_rad_s > 0.0; });
  if (points.size() < 5 || forward == 0 || forward == static_cast<std::ptrdiff_t>(points.size()))
    return std::nullopt;
  FrictionCurve curve = curve_of(points);
  for (int round = 0; round < kRounds; ++round) curve = curve_of(reweighted(points, curve));
  double squares = 0.0;
  for (const FrictionPoint& p : points) squares += std::pow(p.torque_nm - curve.at(p.speed_rad_s), 2);
  curve.residual_nm = std::sqrt(squares / static_cast<double>(points.size()));
  return curve;
}

}  // namespace servogate::bench
