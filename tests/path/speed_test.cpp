// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/speed.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/path/law/judge.hpp"

namespace servogate::path {
namespace {

using Sets = std::array<AxisLimits, kMaxAxes>;

Sets alike(double v, double a, double j) {
  Sets sets{};
  sets.fill({v, a, j});
  return sets;
}

/// One axis from rest to rest over `length`, the clock a smooth step of `seconds`.
struct Straight {
  Straight(double length, double seconds, int intervals, const Sets& limits) {
    for (int i = -1; i <= intervals + 1; ++i) {
      const double z = std::min(std::max(static_cast<double>(i) / intervals, 0.0), 1.0);
      controls.push_back(length * z * z * z * (10 - 15 * z + 6 * z * z));
    }
    controls[1] = controls[2] = controls[0];
    controls[static_cast<std::size_t>(intervals)] = controls[static_cast<std::size_t>(intervals) + 1] =
        controls.back();
    bounds.assign(static_cast<std::size_t>(intervals) + 1, {HUGE_VAL, &limits});
    problem.axes = 1;
    problem.step = seconds / intervals;
    problem.controls = controls;
    problem.bounds = bounds;
    problem.beta.assign(static_cast<std::size_t>(intervals) + 2, 0.04);
  }
  std::vector<double> controls;
  std::vector<KnotBound> bounds;
  SpeedProblem problem;
};

TEST(SpeedLaw, drives_a_straight_line_as_fast_as_it_can_be) {
  // Seven phases at 100 mm/s: 100 / 100 + 0.1 + 0.1 s; without reaching the speed, 2 (l / 2 j)^(1/3) for each
  // half.
  const Sets mill = alike(100, 1000, 10000);
  Straight longer(100, 1.5, 400, mill);
  SpeedLaw law;
  law.prepare(longer.problem);
  ASSERT_TRUE(law.solve(longer.problem));
  EXPECT_NEAR(law.time(longer.problem.beta), 1.2, 0.008);
  Straight shorter(1, 0.3, 200, mill);
  law.prepare(shorter.problem);
  ASSERT_TRUE(law.solve(shorter.problem));
  EXPECT_NEAR(law.time(shorter.problem.beta), 4 * std::cbrt(1.0 / (2 * 10000)), 0.004);
}

TEST(SpeedLaw, keeps_the_limits_between_the_places_that_it_looks_at_too) {
  const Sets mill = alike(100, 1000, 10000);
  Straight line(100, 1.5, 400, mill);
  line.problem.share = 0.99;
  SpeedLaw law;
  law.prepare(line.problem);
  ASSERT_TRUE(law.solve(line.problem));
  std::vector<Excess> excess;
  judge(line.problem, 400, excess);
  for (const Excess& e : excess) EXPECT_LE(e.most(), 1.0);
  double sum = 0.0;
  for (std::size_t k = 0; k < 400; ++k) sum += interval_time(line.problem.beta, k, line.problem.step);
  EXPECT_NEAR(sum, law.time(line.problem.beta), 1e-3);
}

TEST(SpeedLaw, takes_limits_and_feed_from_each_knot) {
  const Sets quick = alike(100, 1000, 10000), slow = alike(100, 200, 2000);
  Straight line(100, 1.5, 400, quick);
  for (std::size_t k = 200; k <= 400; ++k) line.bounds[k].limits = &slow;
  for (std::size_t k = 100; k < 150; ++k) line.bounds[k].feed = 20.0;
  line.problem.beta.assign(line.problem.beta.size(), 0.01);
  SpeedLaw law;
  law.prepare(line.problem);
  ASSERT_TRUE(law.solve(line.problem));
  std::vector<Excess> excess;
  judge(line.problem, 400, excess);
  const double i1 = 1.0 / line.problem.step;
  for (std::size_t k = 0; k < 400; ++k) {
    EXPECT_LE(excess[k].most(), 1.01) << k;
    if (k < 100 || k >= 150) continue;
    const double d1 = 0.5 * i1 * (line.controls[k + 2] - line.controls[k]);
    EXPECT_LE(d1 * std::sqrt(0.5 * (line.problem.beta[k] + line.problem.beta[k + 1])), 20.0) << k;
  }
}

TEST(SpeedLaw, says_no_where_the_start_is_not_inside_and_leaves_it) {
  const Sets mill = alike(100, 1000, 10000);
  Straight line(100, 0.1, 400, mill);
  line.problem.beta.assign(line.problem.beta.size(), 1.0);
  const std::vector<double> before = line.problem.beta;
  SpeedLaw law;
  law.prepare(line.problem);
  EXPECT_FALSE(law.solve(line.problem));
  EXPECT_EQ(line.problem.beta, before);
}

TEST(SpeedLaw, keeps_what_is_given_at_both_ends) {
  const Sets mill = alike(100, 1000, 10000);
  Straight line(100, 1.5, 400, mill);
  line.problem.fixed_head = line.problem.fixed_tail = 2;
  SpeedLaw law;
  law.prepare(line.problem);
  ASSERT_TRUE(law.solve(line.problem));
  EXPECT_EQ(line.problem.beta[0], 0.04);
  EXPECT_EQ(line.problem.beta[1], 0.04);
  EXPECT_EQ(line.problem.beta[400], 0.04);
  EXPECT_EQ(line.problem.beta[401], 0.04);
}

}  // namespace
}  // namespace servogate::path
