// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/run.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kExact = 0.0015;  // mm: a bored circle is no worse than that
// How far from its ends a leg may use its tolerance, mm and by the tolerance; twice as far it is exact.
constexpr double kEnds = 0.5, kEndsByTolerance = 20.0;

}  // namespace

double fastest(const Leg& leg, int axes) {
  double square = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i)
    if (moves(leg, i)) square += (*leg.limits)[i].velocity * (*leg.limits)[i].velocity;
  return std::min(leg.feed, std::sqrt(square));
}

std::uint32_t axes_moved(const Config& config, const Piece& piece) {
  if (config.transformation == &identity()) return 0;
  std::uint32_t moved = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(config.axis_count); ++i) {
    if (!moves(piece, i)) continue;
    Vector unit{};
    unit[i] = 1.0;
    const Vector turned = turned_to_axes(*config.transformation, unit, config.axis_count);
    for (std::size_t k = 0; k < static_cast<std::size_t>(config.axis_count); ++k)
      if (std::abs(turned[k]) > 1e-9) moved |= 1u << k;
  }
  return moved;
}

void Run::append(Leg leg) {
  leg.begin = length();
  legs_.push_back(leg);
}

void Run::forget_before(double u) {
  std::size_t n = legs_.begin();
  while (n + 1 < legs_.end() && legs_[n].end() <= u) ++n;
  legs_.forget_before(n);
}

std::size_t Run::leg_at(double u, std::size_t near) const {
  std::size_t n = std::clamp(near, legs_.begin(), legs_.end() - 1);
  while (n + 1 < legs_.end() && legs_[n + 1].begin <= u) ++n;
  while (n > legs_.begin() && legs_[n].begin > u) --n;
  return n;
}

Vector Run::at(double u, std::size_t near) const {
  const Leg& leg = legs_[leg_at(u, near)];
  return path::position(leg.piece, std::clamp(u - leg.begin, 0.0, leg.piece.length), axes_);
}

double Run::foot(const Vector& x, const Leg& leg, double u) const {
  double s = std::clamp(u - leg.begin, 0.0, leg.piece.length);
  const int steps = leg.piece.shape == Piece::Shape::line ? 1 : 3;
  for (int q = 0; q < steps; ++q) {
    const PathPoint p = evaluate(leg.piece, s, axes_);
    double along = 0.0, square = 0.0;
    for (int i = 0; i < axes_; ++i) {
      along += (x[i] - p.x[i]) * p.d1[i];
      square += p.d1[i] * p.d1[i];
    }
    s = std::clamp(s + along / square, 0.0, leg.piece.length);
  }
  return leg.begin + s;
}

double Run::downhill(const Vector& x, double u, double reach, std::size_t near) const {
  std::size_t n = leg_at(u, near);
  const double low = u - reach, high = u + reach;
  double w = std::clamp(foot(x, legs_[n], u), low, high);
  if (w >= legs_[n].end()) {
    while (n + 1 < legs_.end() && w >= legs_[n].end() && w < high) {
      ++n;
      const double f = std::min(foot(x, legs_[n], legs_[n].begin), high);
      if (f <= legs_[n].begin) return legs_[n].begin;
      w = f;
    }
    return w;
  }
  while (n > legs_.begin() && w <= legs_[n].begin && w > low) {
    --n;
    const double f = std::max(foot(x, legs_[n], legs_[n].end()), low);
    if (f >= legs_[n].end()) return legs_[n].end();
    w = f;
  }
  return w;
}

double Run::radius(double u, std::size_t n) const {
  const Leg& leg = legs_[n];
  if (leg.exact) return std::min(leg.tolerance, kExact);
  const double from_end = std::min(u - leg.begin, leg.end() - u),
               zone = kEnds + kEndsByTolerance * leg.tolerance;
  if (from_end <= zone || leg.tolerance <= kExact) return leg.tolerance;
  return std::max(kExact, leg.tolerance * (2.0 - from_end / zone));
}

}  // namespace servogate::path
