// SPDX-License-Identifier: Apache-2.0
// Holds and overrides below 100 % along lines of a course: at once, and as fast as the axes can.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "kernel/path/law/s_curve.hpp"
#include "tests/path/rig/driven_path.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

constexpr double kLine = 260.0, kFeed = 100.0;

/// A line along the first axis, of which the last part is slower, a corner, two more lines.
std::vector<Element> lines(double corner_x, double corner_y) {
  return {line_to(kLine - 60, 0, 0, kFeed), line_to(kLine, 0, 0, 0.4 * kFeed),
          line_to(kLine + corner_x, corner_y, 0, kFeed), line_to(0, corner_y, 0, kFeed)};
}

struct Machine : DrivenPath {
  explicit Machine(const std::vector<Element>& elements, double turns = 0.0) : DrivenPath(course()) {
    for (Element e : elements) {
      e.revolutions = turns;
      planner.add(e);
    }
    planner.finish();
    if (turns > 0.0) follower.set_spindle(turns);
  }
  static Config course() {
    Config config = mill();
    config.law = Law::course;
    return config;
  }
  /// The fastest change from here to a speed along the first axis.
  Profile fastest(double speed) const {
    const AxisLimits& x = config.limits[0];
    Profile ramp;
    ramp.start({last.position[0], last.velocity[0], last.acceleration[0]});
    add_ramp(ramp, last.velocity[0], last.acceleration[0], speed, {x.velocity, x.acceleration, x.jerk});
    return ramp;
  }
  int least_cycles(double speed) const {
    return static_cast<int>(std::ceil(fastest(speed).duration() / config.period_s));
  }
  int hold_cycles() {
    follower.hold();
    int cycles = 0;
    while (step().state == FollowerState::holding) ++cycles;
    return cycles;
  }
  void expect_to_end(double x, double y) {
    follower.resume();
    follower.set_override(1.0);
    ASSERT_TRUE(until(FollowerState::idle));
    EXPECT_NEAR(last.position[0], x, 1e-9);
    EXPECT_NEAR(last.position[1], y, 1e-9);
    EXPECT_LE(most(), 1.001);
  }
};

TEST(EarlyBranch, holds_on_a_line_in_the_least_time_while_it_speeds_up_cruises_and_slows_down) {
  for (const double turns : {0.0, 10.0}) {
    int speeding = 0, slowing = 0, holds = 0;
    for (int at = 20, step = 31;; at += step) {
      Machine m(lines(0, 30), turns);
      for (int k = 0; k < at; ++k) m.step();
      const double v = m.last.velocity[0], a = m.last.acceleration[0];
      const double way = m.last.position[0];
      step = std::abs(way - (kLine - 66)) < 16 ? 17 : way < 25 ? 31 : 211;
      if (m.fastest(0.0).end().s > kLine - 0.5) break;  // its stop would lead into the corner
      speeding += a > 50.0 ? 1 : 0;
      slowing += a < -50.0 ? 1 : 0;
      const int least = m.least_cycles(0.0);
      EXPECT_LE(m.hold_cycles(), least + 1) << "at " << way << " mm, " << v << " mm/s, " << a << " mm/s2";
      EXPECT_LT(m.last.position[0], kLine);
      if (holds++ % 4 == 0) m.expect_to_end(0, 30);
    }
    EXPECT_GE(speeding, 3);
    EXPECT_GE(slowing, 1);
  }
}

TEST(EarlyBranch, holds_before_in_and_behind_a_corner_in_little_more_than_the_way_through_it) {
  for (const auto& [x, y] : {std::pair{0.0, 30.0}, {30.0, 20.0}, {60.0, 6.0}}) {
    for (double way = kLine - 10.0; way < kLine + 2.0; way += 1.3) {
      Machine m(lines(x, y));
      ASSERT_TRUE(m.until([&](const Sample& s) { return s.position[0] + s.position[1] > way; }));
      EXPECT_LE(m.hold_cycles(), 300) << way << ", corner to " << x << ' ' << y;
      m.expect_to_end(0, y);
    }
  }
}

TEST(EarlyBranch, of_an_override_is_as_fast_as_the_axes_too) {
  for (const double ratio : {0.75, 0.3}) {
    for (const int at : {230, 600, 1200}) {
      Machine m(lines(0, 30));
      for (int k = 0; k < at; ++k) m.step();
      const int least = m.least_cycles(ratio * kFeed);
      m.follower.set_override(ratio);
      int cycles = 0;
      while (m.step().feed > 1.001 * ratio * kFeed && cycles < 1000) ++cycles;
      EXPECT_LE(cycles, least + 1) << ratio << " at " << at;
      for (int k = 0; k < 200; ++k) m.step();
      EXPECT_NEAR(m.last.feed, ratio * kFeed, 0.002 * kFeed) << ratio << " at " << at;
      m.expect_to_end(0, 30);
    }
  }
}

TEST(EarlyBranch, goes_on_behind_a_hold_as_fast_as_the_axes_can) {
  Machine m(lines(0, 30));
  for (int k = 0; k < 700; ++k) m.step();
  m.hold_cycles();
  const int least = m.least_cycles(0.999 * kFeed);
  m.follower.resume();
  int cycles = 0;
  while (m.step().feed < 0.99 * kFeed && cycles < 1000) ++cycles;
  EXPECT_LE(cycles, least + 1);
  m.expect_to_end(0, 30);
}

TEST(EarlyBranch, is_left_for_another_wish_in_the_cycle_in_which_it_comes) {
  Machine m(lines(0, 30));
  for (int k = 0; k < 700; ++k) m.step();
  m.follower.set_override(0.5);
  for (int k = 0; k < 60; ++k) m.step();
  EXPECT_LE(m.hold_cycles(), m.least_cycles(0.0) + 200);
  m.follower.resume();
  for (int k = 0; k < 60; ++k) m.step();
  EXPECT_GT(m.last.acceleration[0], 300.0);
  const int least = m.least_cycles(0.0);
  EXPECT_LE(m.hold_cycles(), least + 1);
  m.expect_to_end(0, 30);
}

TEST(EarlyBranch, keeps_limits_and_tolerance_through_lines_of_all_lengths_whatever_is_asked) {
  const std::uint64_t base = servogate::test::property_seed();
  for (std::uint64_t seed = base; seed < base + 12; ++seed) {
    std::mt19937_64 random(seed);
    const auto between = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() % 10001) / 10000.0;
    };
    RandomProgram p;
    p.config = Machine::course();
    p.tolerance = 0.01;
    double x = 0, y = 0, z = 0;
    for (int n = 0; n < 8; ++n) {
      const double far = n % 3 == 2 ? 8.0 : 120.0;
      x += between(-far, far), y += between(-far, far), z += n % 2 == 0 ? between(-far, far) : 0.0;
      p.elements.push_back(line_to(x, y, z, between(20, 200)));
    }
    Scenario s;
    s.seed = seed;
    s.overrides = s.holds = true;
    s.disturbed = 6000;
    EXPECT_EQ(verdict(run(p, s), p), "") << "seed " << seed;
  }
}

}  // namespace
}  // namespace servogate::path::test
