// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "kernel/program/geometry/spline.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program::tests {
namespace {

Position place(double x, double y) {
  Position p{};
  p[0] = x;
  p[1] = y;
  return p;
}

const std::vector<Position> kWave = {place(0, 0), place(10, 10), place(20, 0), place(30, 10), place(40, 0)};

/// Source: specification A 11, T-SPL-01.
TEST(Spline, has_the_middles_of_the_specification_for_each_end_condition) {
  const double middles[4][4][2] = {
      {{5.0000, 7.6786}, {15.0000, 4.4643}, {25.0000, 4.4643}, {35.0000, 7.6786}},
      {{5.6565, 4.9613}, {14.8239, 5.1933}, {25.0480, 4.2655}, {34.9840, 7.7448}},
      {{5.0160, 7.7448}, {14.9520, 4.2655}, {25.1761, 5.1933}, {34.3435, 4.9613}},
      {{5.6657, 5.0000}, {14.7781, 5.0000}, {25.2219, 5.0000}, {34.3343, 5.0000}}};
  for (int ends = 0; ends < 4; ++ends) {
    const std::optional<Position> along = place(1, 0);
    const Spline spline(kWave, 2, (ends & 1) != 0 ? along : std::nullopt,
                        (ends & 2) != 0 ? along : std::nullopt);
    for (std::size_t span = 0; span < 4; ++span) {
      const Position middle = spline.at(span, 0.5);
      EXPECT_NEAR(middles[ends][span][0], middle[0], 1e-4) << "ends " << ends << " span " << span;
      EXPECT_NEAR(middles[ends][span][1], middle[1], 1e-4) << "ends " << ends << " span " << span;
    }
  }
}

TEST(Spline, passes_through_its_points_with_one_direction_and_one_bend) {
  std::mt19937_64 random(servogate::test::property_seed());
  std::uniform_real_distribution<> number(-50.0, 50.0);
  for (int i = 0; i < 200; ++i) {
    std::vector<Position> points;
    for (int k = 0; k < 6; ++k) points.push_back(place(number(random), number(random)));
    const Spline spline(points, 2, std::nullopt, std::nullopt);
    for (std::size_t span = 0; span + 1 < spline.spans(); ++span) {
      const double before =
          std::hypot(points[span + 1][0] - points[span][0], points[span + 1][1] - points[span][1]);
      const double behind =
          std::hypot(points[span + 2][0] - points[span + 1][0], points[span + 2][1] - points[span + 1][1]);
      constexpr double kStep = 1e-3;
      for (std::size_t a = 0; a < 2; ++a) {
        const auto left = [&](double s) { return spline.at(span, 1.0 - s)[a]; };
        const auto right = [&](double s) { return spline.at(span + 1, s)[a]; };
        EXPECT_NEAR(points[span + 1][a], left(0.0), 1e-9);
        EXPECT_NEAR(points[span + 1][a], right(0.0), 1e-9);
        // One-sided differences of second order, exact but for the third derivative.
        const double slope_left =
            (3.0 * left(0.0) - 4.0 * left(kStep) + left(2.0 * kStep)) / (2.0 * kStep * before);
        const double slope_right =
            (-3.0 * right(0.0) + 4.0 * right(kStep) - right(2.0 * kStep)) / (2.0 * kStep * behind);
        EXPECT_NEAR(slope_left, slope_right, 1e-2 * (1.0 + std::abs(slope_left)));
      }
    }
  }
}

TEST(Spline, is_never_further_from_its_chords_than_asked) {
  const Spline spline(kWave, 2, std::nullopt, std::nullopt);
  constexpr double kTolerance = 0.0005;
  for (std::size_t span = 0; span < spline.spans(); ++span) {
    const int parts = spline.parts(span, kTolerance);
    for (int part = 0; part < parts; ++part) {
      const Position a = spline.at(span, static_cast<double>(part) / parts),
                     b = spline.at(span, (part + 1.0) / parts), m = spline.at(span, (part + 0.5) / parts);
      EXPECT_LE(std::hypot(m[0] - (a[0] + b[0]) / 2.0, m[1] - (a[1] + b[1]) / 2.0), kTolerance * 1.01);
    }
  }
}

}  // namespace
}  // namespace servogate::program::tests
