// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>

namespace servogate::axis {

/// Counts of the drive to machine position and back. The ratio is exact, the reference is a pair of integers
/// and one position, nothing is accumulated: no drift, however long and far the axis moves.
struct CountScale {
  std::int64_t numerator = 1;         ///< counts ...
  std::int64_t denominator = 1;       ///< ... in so many mm or degrees; both > 0
  int direction = 1;                  ///< +1: counts rise with the position, -1: they fall
  std::int64_t reference_counts = 0;  ///< here ...
  double reference_position = 0.0;    ///< ... the machine position is this

  /// Machine position of a count. real-time safe.
  double position(std::int64_t counts) const noexcept {
    const std::int64_t d = (counts - reference_counts) * direction;
    const std::int64_t whole = d / numerator, rest = d % numerator;
    return reference_position + static_cast<double>(whole) * static_cast<double>(denominator) +
           static_cast<double>(rest) * static_cast<double>(denominator) / static_cast<double>(numerator);
  }
  /// Nearest count of a machine position. real-time safe.
  std::int64_t counts(double position) const noexcept {
    return reference_counts + direction * std::llround((position - reference_position) * per_unit());
  }
  /// Counts in one mm or degree. real-time safe.
  double per_unit() const noexcept {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
  /// Velocity in units/s of a velocity in counts/s, and back. real-time safe.
  double velocity(double counts_s) const noexcept { return direction * counts_s / per_unit(); }
  double velocity_counts(double velocity_s) const noexcept { return direction * velocity_s * per_unit(); }
};

}  // namespace servogate::axis
