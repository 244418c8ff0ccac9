// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/response/positioning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace servogate::bench {
namespace {

TEST(Positioning, has_the_figures_that_two_targets_and_four_approaches_give_by_hand) {
  // Deviations at 0: up 1, 3, down -1, -3; at 100: up 4, 6, down 2, 4. Standard deviation of each: sqrt(2).
  const double s = std::sqrt(2.0);
  const std::vector<Approach> a = {{0, 1, true},     {0, 3, true},     {0, -1, false},    {0, -3, false},
                                   {100, 104, true}, {100, 106, true}, {100, 102, false}, {100, 104, false}};
  const auto p = positioning(a);
  ASSERT_TRUE(p);
  ASSERT_EQ(p->targets.size(), 2u);
  EXPECT_NEAR(p->targets[0].reversal, 4.0, 1e-12);
  EXPECT_NEAR(p->targets[1].reversal, 2.0, 1e-12);
  EXPECT_NEAR(p->reversal, 4.0, 1e-12);
  EXPECT_NEAR(p->mean_reversal, 3.0, 1e-12);
  EXPECT_NEAR(p->repeatability_up, 4.0 * s, 1e-12);
  EXPECT_NEAR(p->repeatability, 4.0 * s + 4.0, 1e-12);
  EXPECT_NEAR(p->systematic, 7.0, 1e-12);          // 5 - (-2)
  EXPECT_NEAR(p->mean_bidirectional, 4.0, 1e-12);  // 4 - 0
  EXPECT_NEAR(p->accuracy, 7.0 + 4.0 * s, 1e-12);  // (5 + 2 s) - (-2 - 2 s)
}

TEST(Positioning, needs_both_directions_at_every_target) {
  std::vector<Approach> a = {{0, 1, true}, {0, 3, true}, {0, -1, false}};
  EXPECT_FALSE(positioning(a));
  EXPECT_FALSE(positioning({}));
  a.push_back({0, -3, false});
  EXPECT_TRUE(positioning(a));
}

struct Path {
  std::vector<double> x, y;
};
/// A circle of 50 about (10, -20) as two axes with these errors drive it.
Path circle(double squareness, double lag, bool clockwise) {
  Path p;
  for (int i = 0; i < 720; ++i) {
    const double a = (clockwise ? -1.0 : 1.0) * i * std::numbers::pi / 360.0;
    const double reversal = (std::cos(a) > 0.0) == clockwise ? -lag : lag;
    p.x.push_back(10.0 + 50.0 * std::cos(a) + squareness * std::sin(a));
    p.y.push_back(-20.0 + 50.0 * std::sin(a) + reversal);
  }
  return p;
}

TEST(Circularity, of_an_exact_circle_is_nothing_and_its_radius_is_known) {
  const Path p = circle(0.0, 0.0, false);
  const auto c = circularity(p.x, p.y, 50.01);
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->centre_x, 10.0, 1e-9);
  EXPECT_NEAR(c->centre_y, -20.0, 1e-9);
  EXPECT_NEAR(c->radius, 50.0, 1e-9);
  EXPECT_NEAR(c->deviation, 0.0, 1e-9);
  EXPECT_NEAR(c->greatest, -0.01, 1e-9);
  EXPECT_NEAR(c->least, -0.01, 1e-9);
}

TEST(Circularity, of_axes_out_of_square_is_the_amount_by_which_they_are) {
  const Path p = circle(0.05, 0.0, false);  // radius 50 + 0.025 sin 2a
  const auto c = circularity(p.x, p.y, 50.0);
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->deviation, 0.05, 2e-4);
}

TEST(Circularity, of_both_directions_shows_the_reversal_of_an_axis) {
  const Path one = circle(0.0, 0.01, false), other = circle(0.0, 0.01, true);
  const auto both = circle_reversal(one.x, one.y, other.x, other.y);
  ASSERT_TRUE(both);
  EXPECT_NEAR(both->hysteresis, 0.02, 1e-3);
  EXPECT_GE(both->bidirectional, 0.02 - 1e-3);
}

TEST(Circularity, needs_a_circle) {
  const std::vector<double> line = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, few = {0, 1};
  EXPECT_FALSE(circularity(line, line, 1.0));
  EXPECT_FALSE(circularity(few, few, 1.0));
}

}  // namespace
}  // namespace servogate::bench
