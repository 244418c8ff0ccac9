// SPDX-License-Identifier: Apache-2.0
#include "bench/path/optimum/tube.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace servogate::bench {
namespace {

const Limits kMill{{500, 500, 500}, {1000, 1000, 1000}, {1e4, 1e4, 1e4}};

Line sampled(double length, double step, const std::function<Triple(double)>& at) {
  const auto count = static_cast<std::size_t>(std::ceil(length / step));
  Line out{length / static_cast<double>(count), {}};
  for (std::size_t i = 0; i <= count; ++i) out.points.push_back(at(out.step * static_cast<double>(i)));
  return out;
}

/// Blocks of 0.1 mm along the first and the second axis in turn.
Triple zigzag(double s) {
  const double block = std::floor(s / 0.1 + 1e-9), on = s - 0.1 * block,
               pairs = 0.1 * std::floor(block / 2.0);
  return std::fmod(block, 2.0) < 0.5 ? Triple{pairs + on, pairs, 0.0} : Triple{pairs + 0.1, pairs + on, 0.0};
}

TEST(Tube, a_straight_line_stays_as_it_is) {
  const Line line = sampled(100, 0.05, [](double s) { return Triple{s, 0, 0}; });
  const Optimum found = fastest(course_of(smoothest(line, 0.01), 1e9), kMill, true);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.seconds, 0.7403, 0.003);
}

TEST(Tube, a_zigzag_takes_little_more_than_its_swing_across_alone) {
  // Across its direction it moves by 0.0707 mm less twice the tolerance in each block, with a jerk of at most
  // sqrt(2) J that changes sign: swing = J' h^3 / 12.
  const double swing = 0.1 / std::sqrt(2.0) - 0.02;
  const double block = std::cbrt(12.0 * swing / (std::sqrt(2.0) * 1e4));
  constexpr int kBlocks = 300;
  const Optimum found =
      fastest(course_of(smoothest(sampled(0.1 * kBlocks, 0.01, zigzag), 0.01), 100), kMill, true);
  EXPECT_TRUE(found.converged);
  EXPECT_GT(found.seconds, block * (kBlocks - 1));
  EXPECT_LT(found.seconds, 1.06 * block * (kBlocks - 1));
}

TEST(Tube, the_path_stays_within_the_tolerance_and_begins_and_ends_where_it_is_programmed) {
  const Line line = sampled(10, 0.01, zigzag);
  const Line smooth = smoothest(line, 0.01);
  ASSERT_EQ(smooth.points.size(), line.points.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < line.points.size(); ++i)
    worst = std::max(worst, std::hypot(smooth.points[i][0] - line.points[i][0],
                                       smooth.points[i][1] - line.points[i][1], smooth.points[i][2]));
  EXPECT_LE(worst, 0.01);
  EXPECT_GT(worst, 0.0095) << "the tolerance is used";
  EXPECT_EQ(smooth.points.front(), line.points.front());
  EXPECT_EQ(smooth.points.back(), line.points.back());
}

TEST(Tube, the_places_have_the_derivatives_of_the_path) {
  // A helix whose parameter is its angle.
  const Line helix = sampled(3, 1e-3, [](double s) { return Triple{std::cos(s), std::sin(s), 0.5 * s}; });
  for (const Place& p : course_of(helix, 100)) {
    if (p.s < 0.01 || p.s > 2.99) continue;
    ASSERT_NEAR(p.d1[0], -std::sin(p.s), 1e-5);
    ASSERT_NEAR(p.d2[1], -std::sin(p.s), 1e-5);
    ASSERT_NEAR(p.d3[1], -std::cos(p.s), 1e-5);
    ASSERT_NEAR(p.d1[2], 0.5, 1e-9);
    ASSERT_NEAR(p.cap, 100 / std::sqrt(1.25), 1e-3);
  }
}

}  // namespace
}  // namespace servogate::bench
