// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/path/shape/smoothing.hpp"

namespace servogate::path {
namespace {

constexpr double kSharpest = 170.0 / 180.0 * std::numbers::pi;
constexpr int kSamples = 16;
constexpr double kSamplingMargin =
    1.04;  // the distance between two of 16 samples, a smooth bell, is at most this higher

double distance(const Vector& a, const Vector& b, int axes) {
  double sum = 0.0;
  for (int i = 0; i < axes; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// Upper bound of the Fréchet distance between the blend and the corner it replaces: both are run through at
/// equal shares of the parameter.
double deviation(const Piece& p, const Piece& before, const Piece& after, double trim, int axes) {
  double worst = 0.0;
  for (int k = 1; k < kSamples; ++k) {
    const double s = p.length * k / kSamples;
    const Vector programmed =
        s < trim ? position(before, before.length - trim + s, axes) : position(after, s - trim, axes);
    worst = std::max(worst, distance(position(p, s, axes), programmed, axes));
  }
  return worst * kSamplingMargin;
}

}  // namespace

double turn(const Piece& before, const Piece& after, int axes) {
  const Vector a = evaluate(before, before.length, axes).d1, b = evaluate(after, 0.0, axes).d1;
  const double na = norm(a, axes), nb = norm(b, axes);
  double difference = 0.0, sum = 0.0;
  for (int i = 0; i < axes; ++i) {
    const double u = a[i] / na, v = b[i] / nb;
    difference += (u - v) * (u - v);
    sum += (u + v) * (u + v);
  }
  return 2.0 * std::atan2(std::sqrt(difference), std::sqrt(sum));
}

bool joins_smoothly(const Piece& before, const Piece& after, int axes) {
  // A step of 2e-10 in the tangent at 500 mm/s is a step of 1e-7 mm/s: below a thousandth of any jerk limit.
  constexpr double kTangent = 2e-10, kCurvature = 1e-10;
  const PathPoint a = evaluate(before, before.length, axes), b = evaluate(after, 0.0, axes);
  return distance(a.d1, b.d1, axes) < kTangent && distance(a.d2, b.d2, axes) < kCurvature;
}

std::optional<Blend> blend(const Piece& before, const Piece& after, double tolerance, int axes) {
  if (!(tolerance > 0.0) || turn(before, after, axes) > kSharpest) return std::nullopt;
  double trim = 0.5 * std::min(before.full, after.full);
  for (int round = 0; round < 40; ++round) {
    const PathPoint a = evaluate(before, before.length - trim, axes), b = evaluate(after, trim, axes);
    Blend out{trim, 0.0, quintic(a, b, 2.0 * trim, axes)};
    out.deviation = deviation(out.piece, before, after, trim, axes);
    if (out.deviation <= tolerance) return out;
    trim *= std::clamp(0.98 * tolerance / out.deviation, 0.05, 0.9);
    if (trim < 1e-9) break;
  }
  return std::nullopt;
}

}  // namespace servogate::path
