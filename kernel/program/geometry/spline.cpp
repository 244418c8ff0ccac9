// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/geometry/spline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace servogate::program {
namespace {

constexpr int kMostParts = 10'000;

double length(const Position& a, std::size_t axes) {
  double square = 0.0;
  for (std::size_t i = 0; i < axes; ++i) square += a[i] * a[i];
  return std::sqrt(square);
}

Position minus(const Position& a, const Position& b) {
  Position out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace

/// The bends of all points are the solution of a system of three diagonals.
Spline::Spline(std::vector<Position> points, std::size_t axes, const std::optional<Position>& first,
               const std::optional<Position>& last)
    : points_(std::move(points)), bends_(points_.size()), lengths_(points_.size() - 1), axes_(axes) {
  const std::size_t n = points_.size();
  for (std::size_t i = 0; i + 1 < n; ++i) lengths_[i] = length(minus(points_[i + 1], points_[i]), axes_);
  const auto slope = [&](std::size_t span, std::size_t a) {
    return (points_[span + 1][a] - points_[span][a]) / lengths_[span];
  };
  std::vector<double> middle(n, 1.0), upper(n, 0.0), lower(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    lower[i] = lengths_[i - 1];
    upper[i] = lengths_[i];
    middle[i] = 2.0 * (lengths_[i - 1] + lengths_[i]);
    for (std::size_t a = 0; a < axes_; ++a) bends_[i][a] = 6.0 * (slope(i, a) - slope(i - 1, a));
  }
  if (first) {
    middle[0] = 2.0 * lengths_[0];
    upper[0] = lengths_[0];
    for (std::size_t a = 0; a < axes_; ++a) bends_[0][a] = 6.0 * (slope(0, a) - (*first)[a]);
  }
  if (last) {
    middle[n - 1] = 2.0 * lengths_[n - 2];
    lower[n - 1] = lengths_[n - 2];
    for (std::size_t a = 0; a < axes_; ++a) bends_[n - 1][a] = 6.0 * ((*last)[a] - slope(n - 2, a));
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = lower[i] / middle[i - 1];
    middle[i] -= factor * upper[i - 1];
    for (std::size_t a = 0; a < axes_; ++a) bends_[i][a] -= factor * bends_[i - 1][a];
  }
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t a = 0; a < axes_; ++a) {
      if (i + 1 < n) bends_[i][a] -= upper[i] * bends_[i + 1][a];
      bends_[i][a] /= middle[i];
    }
}

Position Spline::at(std::size_t span, double share) const {
  const double h = lengths_[span], s = share, r = 1.0 - share;
  Position out{};
  for (std::size_t a = 0; a < axes_; ++a)
    out[a] = r * points_[span][a] + s * points_[span + 1][a] +
             h * h / 6.0 * ((r * r * r - r) * bends_[span][a] + (s * s * s - s) * bends_[span + 1][a]);
  return out;
}

/// A chord of the length h leaves a curve by its bend times h squared over eight.
int Spline::parts(std::size_t span, double tolerance) const {
  const double bend = std::max(length(bends_[span], axes_), length(bends_[span + 1], axes_));
  const double parts = lengths_[span] * std::sqrt(bend / (8.0 * tolerance));
  return std::clamp(static_cast<int>(std::ceil(parts)), 1, kMostParts);
}

}  // namespace servogate::program
