// SPDX-License-Identifier: Apache-2.0
// Holds on curves that need all of the axes: stops that go by what the path leaves at each place.
#include "kernel/path/law/stop_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "kernel/path/law/rate_motion.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/path/rig/course.hpp"
#include "tests/path/rig/published_course.hpp"

namespace servogate::path::test {
namespace {

/// The outline of a cam, as a CAM system gives it: about 0.6 mm a block, at the limits of the axes nearly
/// throughout.
RandomProgram cam(double radius, double feed) {
  constexpr int kBlocks = 1000;
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  for (int n = 1; n <= kBlocks; ++n) {
    const double t = n * std::numbers::pi / kBlocks;
    const double r = radius * (1.0 + 0.3 * std::sin(5.0 * t) + 0.08 * std::sin(17.0 * t));
    p.elements.push_back(
        line_to(r * std::cos(t) - radius, r * std::sin(t), 0.05 * radius * std::sin(7.0 * t), feed));
  }
  return p;
}

struct Hold {
  int cycles = 0;
  double way = 0.0;  ///< mm
  Reached reached;
};

Hold hold(const PublishedCourse& c, RateMotion motion) {
  Hold out;
  const double place = motion.point(c).place;
  Polyline points;
  for (; !motion.at_rest() && out.cycles < 10000; ++out.cycles) {
    points.push_back(motion.point(c).x);
    motion.step(c, 0.0, 0.001);
  }
  for (int n = 0; n < 4; ++n) points.push_back(motion.point(c).x);
  out.way = std::abs(motion.point(c).place - place);
  out.reached = reached(points, c.p.config, 0.001);
  return out;
}

TEST(StopPlan, is_a_rate_with_its_derivatives_and_its_integral_that_ends_in_rest) {
  StopPlan plan;
  plan.begin(0.8, 0.5, 0.01);
  for (const double bend : {-200.0, -150.0, 0.0, 40.0, -10.0}) plan.add(bend);
  plan.close();
  EXPECT_NEAR(plan.at(0.0).rate, 0.8, 1e-12);
  EXPECT_NEAR(plan.at(0.0).slope, 0.5, 1e-12);
  const double h = 1e-6;
  for (double t = 0.0015; t < plan.seconds - 0.001; t += 0.001) {
    EXPECT_NEAR(plan.at(t).rate, (plan.at(t + h).passed - plan.at(t - h).passed) / (2 * h), 1e-8);
    EXPECT_NEAR(plan.at(t).slope, (plan.at(t + h).rate - plan.at(t - h).rate) / (2 * h), 1e-6);
    EXPECT_NEAR(plan.at(t).bend, (plan.at(t + h).slope - plan.at(t - h).slope) / (2 * h), 1e-3);
  }
  for (const double behind : {0.0, 1.0}) {
    EXPECT_NEAR(plan.at(plan.seconds + behind).rate, 0.0, 1e-12);
    EXPECT_NEAR(plan.at(plan.seconds + behind).slope, 0.0, 1e-12);
    EXPECT_NEAR(plan.at(plan.seconds + behind).passed, plan.at(plan.seconds - 1e-9).passed, 1e-9);
  }
}

TEST(StopSearch, finds_the_same_stop_in_one_call_and_in_many_and_never_allocates) {
  const PublishedCourse c(cam(60, 200));
  ASSERT_TRUE(c.whole());
  RateMotion motion(c.limits);
  for (int n = 0; n < 500; ++n) motion.step(c, 1.0, 0.001);
  const CourseState from{motion.time(), motion.knot(), 1.0, 0.0};
  StopSearch whole, parts;
  const auto before = servogate::counting::allocations();
  whole.begin(from, 0.6);
  int places = 1 << 20;
  ASSERT_EQ(whole.go(c, c.limits, false, places), Fit::fits);
  parts.begin(from, 0.6);
  int calls = 0, most = 0;
  Fit fit = Fit::open;
  for (; fit == Fit::open; ++calls) {
    places = 100;
    fit = parts.go(c, c.limits, false, places);
    most = std::max(most, 100 - places);
  }
  EXPECT_EQ(servogate::counting::allocations(), before);
  ASSERT_EQ(fit, Fit::fits);
  EXPECT_GT(calls, 10);
  EXPECT_LE(most, 100 + StopSearch::kPast);
  EXPECT_EQ(parts.plan().seconds, whole.plan().seconds);
  EXPECT_EQ(parts.rests_at().ns, whole.rests_at().ns);
  EXPECT_LT(whole.plan().seconds, 0.6);
}

TEST(StopSearch, concludes_with_the_best_stop_so_far_and_says_where_there_is_none) {
  const PublishedCourse c(cam(60, 200));
  RateMotion motion(c.limits);
  for (int n = 0; n < 500; ++n) motion.step(c, 1.0, 0.001);
  const CourseState from{motion.time(), motion.knot(), 1.0, 0.0};
  StopSearch search;
  search.begin(from, 0.6);
  int places = 10;
  ASSERT_EQ(search.go(c, c.limits, false, places), Fit::open);
  EXPECT_EQ(search.go(c, c.limits, true, places), Fit::breaks) << "nothing was found yet";
  search.begin(from, 0.02);
  places = 1 << 20;
  EXPECT_EQ(search.go(c, c.limits, false, places), Fit::breaks) << "no stop takes 20 ms from there";
}

TEST(StopSearch, goes_no_further_than_what_is_published) {
  PublishedCourse c(cam(60, 200));
  RateMotion motion(c.limits);
  for (int n = 0; n < 500; ++n) motion.step(c, 1.0, 0.001);
  const CourseState from{motion.time(), motion.knot(), 1.0, 0.0};
  StopSearch search;
  search.begin(from, 0.6);
  int places = 1 << 20;
  ASSERT_EQ(search.go(c, c.limits, false, places), Fit::fits);
  c.hidden_from = motion.knot() + 4;
  EXPECT_LT(c.knot(c.hidden_from - 1)->t.since(search.rests_at()), 0.0);
  search.begin(from, 0.6);
  EXPECT_EQ(search.go(c, c.limits, false, places), Fit::breaks);
}

TEST(Hold, on_a_cam_at_the_limits_rests_in_a_third_of_a_second_on_average_and_keeps_all_limits) {
  for (const auto& [radius, feed, cycles, way] :
       {std::tuple{60.0, 200.0, 330.0, 18.0}, {30.0, 333.0, 290.0, 11.0}}) {
    SCOPED_TRACE(radius);
    const PublishedCourse c(cam(radius, feed));
    ASSERT_TRUE(c.whole());
    RateMotion motion(c.limits);
    double taken = 0.0, gone = 0.0;  // cycles, mm
    int holds = 0, longest = 0;
    Reached most;
    for (int n = 0; motion.step(c, 1.0, 0.001); ++n) {
      if (n < 20 || n % 23 != 0) continue;
      const Hold h = hold(c, motion);
      ++holds;
      taken += h.cycles;
      gone += h.way;
      longest = std::max(longest, h.cycles);
      most = {std::max(most.velocity, h.reached.velocity),
              std::max(most.acceleration, h.reached.acceleration), std::max(most.jerk, h.reached.jerk)};
    }
    std::printf("%d holds: %.0f cycles and %.1f mm on average, at most %d cycles\n", holds, taken / holds,
                gone / holds, longest);
    EXPECT_LE(taken, holds * cycles);
    EXPECT_LE(gone, holds * way);
    EXPECT_LE(most.velocity, 1.001);
    EXPECT_LE(most.acceleration, 1.001);
    EXPECT_LE(most.jerk, 1.001);
  }
}

TEST(Hold, while_the_speed_comes_back_from_another_one_is_no_longer) {
  const PublishedCourse c(cam(60, 200));
  RateMotion motion(c.limits);
  for (int n = 0; n < 1500; ++n) motion.step(c, 1.0, 0.001);
  while (!motion.at_rest()) motion.step(c, 0.0, 0.001);
  double taken = 0.0;
  int holds = 0, longest = 0;
  for (int n = 0; n < 900 && motion.step(c, 1.0, 0.001); ++n) {
    if (n < 20 || n % 3 != 0) continue;
    const Hold h = hold(c, motion);
    taken += h.cycles;
    longest = std::max(longest, h.cycles);
    ++holds;
    EXPECT_LE(std::max(h.reached.acceleration, h.reached.jerk), 1.001) << n;
  }
  std::printf("%d holds: %.0f cycles on average, at most %d\n", holds, taken / holds, longest);
  EXPECT_LE(taken, 300.0 * holds);
  EXPECT_LE(longest, 600);
}

TEST(Hold, on_the_way_back_along_a_cam_keeps_all_limits_and_is_as_soon) {
  const PublishedCourse c(cam(60, 200));
  RateMotion motion(c.limits);
  for (int n = 0; n < 3000; ++n) motion.step(c, 1.0, 0.001);
  double taken = 0.0;
  int holds = 0;
  for (int n = 0; motion.step(c, -1.0, 0.001); ++n) {
    if (motion.rate() > -1.0 || n % 23 != 0) continue;
    const Hold h = hold(c, motion);
    taken += h.cycles;
    ++holds;
    EXPECT_LE(h.reached.acceleration, 1.001);
    EXPECT_LE(h.reached.jerk, 1.001);
  }
  std::printf("%d holds: %.0f cycles on average\n", holds, taken / holds);
  EXPECT_GT(holds, 50);
  EXPECT_LE(taken, 330.0 * holds);
}

}  // namespace
}  // namespace servogate::path::test
