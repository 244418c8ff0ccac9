// SPDX-License-Identifier: Apache-2.0
#include "bench/path/optimum/optimum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace servogate::bench {
namespace {

constexpr double kNone = 1e9;

Limits alike(double v, double a, double j) { return {{v, v, v}, {a, a, a}, {j, j, j}}; }

/// Along a direction, as shares of the axes.
Course line(double length, const Triple& direction, double cap = kNone) {
  Course out;
  for (const double s : graded(length, length / 2000.0)) out.push_back({s, direction, {}, {}, cap});
  return out;
}

/// Radius 20 from -60 to 60 degrees: the first axis moves on in one direction.
Course arc(double cap) {
  constexpr double kRadius = 20.0, kSweep = 2.0 * std::numbers::pi / 3.0;
  Course out;
  for (const double s : graded(kRadius * kSweep, 0.02)) {
    const double angle = s / kRadius - 0.5 * kSweep, c = std::cos(angle), n = std::sin(angle);
    out.push_back({s,
                   {c, -n, 0.0},
                   {-n / kRadius, -c / kRadius, 0.0},
                   {-c / (kRadius * kRadius), n / (kRadius * kRadius), 0.0},
                   cap});
  }
  return out;
}

void expect_seconds(double known, const Course& course, const Limits& limits, bool with_jerk) {
  const Optimum found = fastest(course, limits, with_jerk);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.seconds, known, 0.003 * known);
}

TEST(Optimum, of_a_line_without_jerk_limit_is_bang_bang) {
  expect_seconds(2.0 * std::sqrt(100.0 / 1000.0), line(100, {1, 0, 0}), alike(500, 1000, kNone), false);
  // At the feed of 100 mm/s: a tenth of a second up and down.
  expect_seconds(1.1, line(100, {1, 0, 0}, 100), alike(500, 1000, kNone), false);
}

TEST(Optimum, of_a_line_from_rest_to_rest_with_jerk_alone_is_the_triple_integrator) {
  expect_seconds(4.0 * std::cbrt(100.0 / 2e4), line(100, {1, 0, 0}), alike(kNone, kNone, 1e4), true);
}

TEST(Optimum, of_a_line_with_all_limits_is_the_s_curve) {
  // 1000 mm/s2 and 10 000 mm/s3 peak at 270.2 mm/s over 100 mm, see tests/path; at 100 mm/s it is 1 + 0.2.
  expect_seconds(0.7403, line(100, {1, 0, 0}), alike(500, 1000, 1e4), true);
  expect_seconds(1.2, line(100, {0, 1, 0}, 100), alike(500, 1000, 1e4), true);
}

TEST(Optimum, of_a_slanted_line_is_that_of_the_axis_that_reaches_its_limit) {
  // The second axis has 0.8 of the way and a quarter of the jerk.
  const Limits limits{{kNone, kNone, kNone}, {kNone, kNone, kNone}, {1e4, 2500, 1e4}};
  expect_seconds(4.0 * std::cbrt(80.0 / 5e3), line(100, {0.6, 0.8, 0}), limits, true);
}

TEST(Optimum, of_an_arc_that_one_axis_binds_is_the_straight_motion_of_that_axis) {
  const double way = 2.0 * 20.0 * std::sin(std::numbers::pi / 3.0);
  Limits limits = alike(kNone, kNone, kNone);
  limits.acceleration[0] = 1000;
  expect_seconds(2.0 * std::sqrt(way / 1000.0), arc(kNone), limits, false);
  limits.acceleration[0] = kNone;
  limits.jerk[0] = 1e4;
  expect_seconds(4.0 * std::cbrt(way / 2e4), arc(kNone), limits, true);
}

TEST(Optimum, without_jerk_limit_is_never_more_than_with_it) {
  for (const double cap : {10.0, 50.0, 200.0}) {
    const Limits limits = alike(500, 1000, 1e4);
    const Optimum with = fastest(arc(cap), limits, true), without = fastest(arc(cap), limits, false);
    EXPECT_LT(without.seconds - without.gap, with.seconds) << cap;
    EXPECT_GT(with.seconds, 40.0 * std::numbers::pi / 3.0 / cap) << cap;
  }
}

}  // namespace
}  // namespace servogate::bench
