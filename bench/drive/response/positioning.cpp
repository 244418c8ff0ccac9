// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/response/positioning.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace servogate::bench {
namespace {

struct Mean {
  double mean = 0.0, deviation = 0.0;
};

Mean mean_of(const std::vector<double>& values) {
  Mean m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  for (const double v : values) m.deviation += (v - m.mean) * (v - m.mean) / (n - 1.0);
  m.deviation = std::sqrt(m.deviation);
  return m;
}

/// The circle that is nearest in the sense of x^2 + y^2 + a x + b y + c = 0 (Kasa 1976), which for a whole
/// turn of evenly taken points is the least-squares circle to the second order of its deviations.
struct Circle {
  double x = 0.0, y = 0.0, radius = 0.0;
};
std::optional<Circle> circle_of(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size() || x.size() < 8) return std::nullopt;
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd a(n, 3);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double px = x[static_cast<std::size_t>(i)], py = y[static_cast<std::size_t>(i)];
    a.row(i) << 2.0 * px, 2.0 * py, 1.0;
    b(i) = px * px + py * py;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  if (qr.rank() < 3) return std::nullopt;
  const Eigen::Vector3d s = qr.solve(b);
  const double square = s(2) + s(0) * s(0) + s(1) * s(1);
  if (!(square > 0.0)) return std::nullopt;
  return Circle{s(0), s(1), std::sqrt(square)};
}

/// Mean radius by angle; NaN where the path was not.
constexpr std::size_t kAngles = 360;
std::array<double, kAngles> radii(std::span<const double> x, std::span<const double> y, const Circle& c) {
  std::array<double, kAngles> sum{}, count{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double turn = std::atan2(y[i] - c.y, x[i] - c.x) / (2.0 * std::numbers::pi) + 1.0;
    const auto at = static_cast<std::size_t>(turn * kAngles) % kAngles;
    sum[at] += std::hypot(x[i] - c.x, y[i] - c.y);
    count[at] += 1.0;
  }
  for (std::size_t i = 0; i < kAngles; ++i) sum[i] /= count[i];
  return sum;
}

}  // namespace

std::optional<Positioning> positioning(std::span<const Approach> approaches) {
  std::map<double, std::array<std::vector<double>, 2>> by_target;
  for (const Approach& a : approaches) by_target[a.target][a.positive ? 0 : 1].push_back(a.actual - a.target);
  if (by_target.empty()) return std::nullopt;
  Positioning out;
  double mean_low = 1e300, mean_high = -1e300, up_low = 1e300, up_high = -1e300, low = 1e300, high = -1e300;
  for (const auto& [target, both] : by_target) {
    if (both[0].size() < 2 || both[1].size() < 2) return std::nullopt;
    const Mean up = mean_of(both[0]), down = mean_of(both[1]);
    const double reversal = up.mean - down.mean;
    out.targets.push_back({target, up.mean, down.mean, 4.0 * up.deviation, 4.0 * down.deviation, reversal});
    out.reversal = std::max(out.reversal, std::abs(reversal));
    out.mean_reversal += reversal / static_cast<double>(by_target.size());
    out.repeatability_up = std::max(out.repeatability_up, 4.0 * up.deviation);
    out.repeatability_down = std::max(out.repeatability_down, 4.0 * down.deviation);
    const double of_target = std::max({2.0 * up.deviation + 2.0 * down.deviation + std::abs(reversal),
                                       4.0 * up.deviation, 4.0 * down.deviation});
    out.repeatability = std::max(out.repeatability, of_target);
    for (const Mean& m : {up, down}) {
      up_low = std::min(up_low, m.mean);
      up_high = std::max(up_high, m.mean);
      low = std::min(low, m.mean - 2.0 * m.deviation);
      high = std::max(high, m.mean + 2.0 * m.deviation);
    }
    const double mean = 0.5 * (up.mean + down.mean);
    mean_low = std::min(mean_low, mean);
    mean_high = std::max(mean_high, mean);
  }
  out.systematic = up_high - up_low;
  out.mean_bidirectional = mean_high - mean_low;
  out.accuracy = high - low;
  return out;
}

std::optional<Circularity> circularity(std::span<const double> x, std::span<const double> y, double nominal) {
  const auto circle = circle_of(x, y);
  if (!circle) return std::nullopt;
  Circularity out;
  out.centre_x = circle->x;
  out.centre_y = circle->y;
  out.radius = circle->radius;
  double low = 1e300, high = -1e300;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = std::hypot(x[i] - circle->x, y[i] - circle->y);
    low = std::min(low, r);
    high = std::max(high, r);
  }
  out.deviation = high - low;
  out.greatest = high - nominal;
  out.least = low - nominal;
  return out;
}

std::optional<CircleReversal> circle_reversal(std::span<const double> x1, std::span<const double> y1,
                                              std::span<const double> x2, std::span<const double> y2) {
  std::vector<double> x(x1.begin(), x1.end()), y(y1.begin(), y1.end());
  x.insert(x.end(), x2.begin(), x2.end());
  y.insert(y.end(), y2.begin(), y2.end());
  const auto circle = circle_of(x, y);
  if (!circle || x1.size() < 8 || x2.size() < 8) return std::nullopt;
  CircleReversal out;
  double low = 1e300, high = -1e300;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = std::hypot(x[i] - circle->x, y[i] - circle->y);
    low = std::min(low, r);
    high = std::max(high, r);
  }
  out.bidirectional = high - low;
  const auto one = radii(x1, y1, *circle), other = radii(x2, y2, *circle);
  for (std::size_t i = 0; i < kAngles; ++i)
    if (std::isfinite(one[i]) && std::isfinite(other[i]))
      out.hysteresis = std::max(out.hysteresis, std::abs(one[i] - other[i]));
  return out;
}

}  // namespace servogate::bench
