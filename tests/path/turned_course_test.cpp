// SPDX-License-Identifier: Apache-2.0
// Feed per revolution and constant surface speed along a course: a lathe's contour in short elements.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/path/rig/driven_path.hpp"

namespace servogate::path::test {
namespace {

constexpr double kTurns = 20.0;  // 1/s
constexpr double kPerTurn = 0.2, kCutting = 2500.0;

Config lathe() {
  Config config = mill();
  config.axis_count = 2;  // radius, length
  return config;
}

struct Lathe : DrivenPath {
  Lathe() : DrivenPath(lathe()) {}
  void begin_at(double radius) {
    follower.set_position({radius});
    planner.restart({radius});
    trip.samples.back().position = {radius};
    at = {radius};
  }
  void to(const Vector& x, const Surface& surface = {}, double turns = kTurns) {
    Element e = line_to(x[0], x[1], 0, kPerTurn * turns, 0.005);
    e.revolutions = turns;
    e.surface = surface;
    ASSERT_TRUE(planner.add(e));
    at = x;
  }
  /// On an element of its own, with the spindle as fast as its nearer end lets it be.
  void cut_to(const Vector& x) {
    Surface surface{kCutting, 0.0, 1.0, 0.0, 0};
    const double near = std::min(std::abs(x[0]), std::abs(at[0]));
    surface.most = std::min(60.0, kCutting / (2 * std::numbers::pi * near));
    to(x, surface, surface.most);
  }
  int courses() const {
    int n = 0;
    for (std::uint64_t k = 0; k < track.entries.written(); ++k)
      n += track.entries[k].kind == Entry::Kind::course ? 1 : 0;
    return n;
  }
  Vector at{};
};

double cutting_turns(double radius) {
  return std::min(60.0, kCutting / (2 * std::numbers::pi * std::abs(radius)));
}

TEST(TurnedCourse, has_the_feed_of_the_spindle_rests_with_it_and_goes_on) {
  Lathe m;
  for (int k = 1; k <= 2000; ++k) m.to({2 * std::sin(k * 0.01), -0.05 * k});
  m.planner.finish();
  const auto feed_after = [&](int cycles) {
    for (int k = 1; k < cycles; ++k) m.step();
    return m.step().feed;
  };
  EXPECT_NEAR(feed_after(1500), kPerTurn * kTurns, 0.01) << "nobody has told its speed: as planned";
  EXPECT_EQ(m.courses(), 1);
  for (const double share : {0.5, 1.0, 1.2, 0.1}) {
    m.follower.set_spindle(kTurns * share);
    EXPECT_NEAR(feed_after(600), kPerTurn * kTurns * share, 0.01 * share) << share;
  }
  m.follower.set_spindle(0.0);
  EXPECT_EQ(feed_after(300), 0.0);
  EXPECT_TRUE(m.follower.waits_for_spindle());
  EXPECT_EQ(m.last.state, FollowerState::moving);
  m.follower.set_spindle(kTurns);
  EXPECT_NEAR(feed_after(600), kPerTurn * kTurns, 0.01);
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_EQ(m.last.starved, 0u);
  EXPECT_LE(m.most(), 1.001);
}

TEST(TurnedCourse, has_the_feed_of_the_spindle_while_that_speeds_up_and_slows_down) {
  Lathe m;
  for (int k = 1; k <= 3000; ++k) m.to({2 * std::sin(k * 0.01), -0.05 * k});
  m.planner.finish();
  m.follower.set_spindle(kTurns);
  for (int k = 0; k < 1000; ++k) m.step();
  double turns = kTurns;
  const auto compare = [&](double turns_in_a_cycle) {
    // A change of rate takes 40 ms.
    EXPECT_NEAR(m.step().feed / kPerTurn, turns, 40 * turns_in_a_cycle + 0.002 * turns) << turns;
  };
  for (const double wanted : {0.4 * kTurns, 0.9 * kTurns, 0.6 * kTurns, kTurns}) {
    while (turns != wanted) {
      turns += std::clamp(wanted - turns, -0.01, 0.01);  // the whole speed in two seconds
      m.follower.set_spindle(turns);
      compare(0.01);
    }
    for (int k = 0; k < 100; ++k) compare(0.01);
    for (int k = 0; k < 100; ++k) compare(0.0);
  }
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_LE(m.most(), 1.001);
}

TEST(TurnedCourse, does_not_begin_before_the_spindle_turns) {
  Lathe m;
  for (int k = 1; k <= 300; ++k) m.to({2 * std::sin(k * 0.01), -0.05 * k});
  m.planner.finish();
  m.follower.set_spindle(0.0);
  for (int k = 0; k < 200; ++k) m.step();
  EXPECT_EQ(m.courses(), 1);
  EXPECT_TRUE(m.follower.waits_for_spindle());
  EXPECT_EQ(m.last.position, Vector{});
  m.follower.set_spindle(kTurns);
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_LE(m.most(), 1.001);
}

TEST(TurnedCourse, rests_before_a_feed_per_revolution_of_a_spindle_that_stands) {
  Lathe m;
  for (int k = 1; k <= 200; ++k) {
    const Element e = line_to(2 * std::sin(k * 0.01), -0.05 * k, 0, 10, 0.005);
    ASSERT_TRUE(m.planner.add(e));
  }
  for (int k = 201; k <= 400; ++k) m.to({2 * std::sin(k * 0.01), -0.05 * k});
  m.planner.finish();
  m.follower.set_spindle(0.0);
  for (int k = 0; k < 4000; ++k) m.step();
  EXPECT_EQ(m.courses(), 2);
  EXPECT_TRUE(m.follower.waits_for_spindle());
  EXPECT_NEAR(m.last.position[1], -10.0, 1e-9);
  m.follower.set_spindle(kTurns);
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_LE(m.most(), 1.001);
}

TEST(TurnedCourse, keeps_the_feed_per_revolution_at_every_radius_of_a_constant_surface_speed) {
  Lathe m;
  m.begin_at(40);
  // A face inwards in short blocks, a shaft, a face outwards as one element, and a taper.
  for (int k = 1; k <= 300; ++k) m.cut_to({40 - 0.1 * k, 0.02 * std::sin(0.1 * k)});
  for (int k = 1; k <= 20; ++k) m.cut_to({10, -0.25 * k});
  m.cut_to({30, -5});
  for (int k = 1; k <= 100; ++k) m.cut_to({30 + 0.05 * k, -5 - 0.1 * k});
  m.planner.finish();
  double turns = cutting_turns(40);
  int steady = 0;
  double slowest = 1e9, fastest = 0.0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    turns += std::clamp(cutting_turns(s.position[0]) - turns, -0.05, 0.05);  // its ramp
    m.follower.set_spindle(turns);
    if (s.state == FollowerState::idle) return true;
    // Not where it begins and ends, and not in the four corners.
    const bool corner = std::abs(s.position[0] - 10) < 0.6 || std::abs(s.position[0] - 30) < 0.6;
    if (corner || s.position[0] > 39.5 || s.position[1] < -14.5) return false;
    ++steady;
    const double per_turn = s.feed / turns;
    slowest = std::min(slowest, per_turn);
    fastest = std::max(fastest, per_turn);
    return false;
  }));
  EXPECT_EQ(m.courses(), 1);
  EXPECT_GT(steady, 10000);
  EXPECT_GT(slowest, 0.99 * kPerTurn);
  EXPECT_LT(fastest, 1.01 * kPerTurn);
  EXPECT_LE(m.most(), 1.001);
}

TEST(TurnedCourse, keeps_the_feed_of_a_spindle_that_slows_down_less_than_its_surface_speed_asks_for) {
  constexpr double kInside = 8.0, kOutside = 30.0, kRamp = 0.015;  // mm; 1/s in a cycle
  Lathe m;
  m.begin_at(kInside);
  double turns = cutting_turns(kInside);
  Surface surface{kCutting, 0.0, 1.0, turns, 0};
  surface.late = turns * turns;
  surface.late_fall = 2.0 * kRamp / m.config.period_s / kPerTurn;
  m.to({kOutside, 0}, surface, turns);
  m.to({kOutside + 5, -5});
  m.planner.finish();
  int late = 0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    turns += std::clamp(cutting_turns(s.position[0]) - turns, -kRamp, kRamp);
    m.follower.set_spindle(turns);
    if (s.state == FollowerState::idle) return true;
    if (s.position[0] < kInside + 1 || s.position[0] > kOutside - 1) return false;
    if (turns > 1.2 * cutting_turns(s.position[0])) ++late;
    EXPECT_NEAR(s.feed / turns, kPerTurn, 0.02 * kPerTurn) << s.position[0];
    return false;
  }));
  EXPECT_GT(late, 500);
  EXPECT_LE(m.most(), 1.001);
}

TEST(TurnedCourse, takes_the_time_of_its_surface_speed) {
  // From radius r0 to r1 at f n(r), n = v / (2 pi r): pi (r0^2 - r1^2) / (f v).
  const double seconds = std::numbers::pi * (40.0 * 40.0 - 10.0 * 10.0) / (kPerTurn * kCutting);
  Config config = lathe();
  std::vector<Element> face;
  for (int k = 1; k <= 300; ++k) {
    const double radius = 40 - 0.1 * k;
    Element e = line_to(radius, 0.02 * std::sin(0.1 * k), 0, 0);
    e.surface = {kCutting, 0.0, 1.0, cutting_turns(radius), 0};
    e.revolutions = e.surface.most;
    e.feed = kPerTurn * e.revolutions;
    face.push_back(e);
  }
  EXPECT_NEAR(estimate(config, {40}, face).seconds, seconds, 0.01 * seconds);
}

}  // namespace
}  // namespace servogate::path::test
