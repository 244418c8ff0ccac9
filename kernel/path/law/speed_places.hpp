// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::path {

/// b at the start, middle and end of an interval, by the beta that it is made of.
inline constexpr double kAt[3][3] = {{0.5, 0.5, 0.0}, {0.125, 0.75, 0.125}, {0.0, 0.5, 0.5}};

inline double at(const double (&weights)[3], const double* beta) {
  return weights[0] * beta[0] + weights[1] * beta[1] + weights[2] * beta[2];
}

/// b at a knot; the last one has no third beta.
inline double at_knot(const double* beta) { return 0.5 * (beta[0] + beta[1]); }

}  // namespace servogate::path
