// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/follower.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/path/rig/driven_path.hpp"

namespace servogate::path::test {
namespace {

using Machine = DrivenPath;

Element stop_at(double x, double y, bool confirm = false) {
  Element e = line_to(x, y, 0, 100);
  e.transition = {Continuation::exact_stop, 0.0, 0.0, 180.0, confirm};
  return e;
}

TEST(Follower, rests_until_there_is_something_to_do) {
  Machine m;
  EXPECT_EQ(m.step().state, FollowerState::idle);
  m.planner.add(line_to(10, 0, 0, 100));
  m.planner.finish();
  EXPECT_EQ(m.step().state, FollowerState::moving);
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_EQ(m.last.position[0], 10.0);
  EXPECT_EQ(m.last.starved, 0u);
}

TEST(Follower, reports_block_feed_and_distance_to_go) {
  Machine m;
  Element e = line_to(30, 40, 0, 100);
  e.tag.line = 7;
  m.planner.add(e);
  m.planner.finish();
  for (int k = 0; k < 300; ++k) m.step();
  EXPECT_EQ(m.last.tag.line, 7);
  EXPECT_NEAR(m.last.feed, 100, 1e-9);
  EXPECT_NEAR(m.last.distance_to_go, 50 - std::hypot(m.last.position[0], m.last.position[1]), 1e-9);
  EXPECT_NEAR(m.last.velocity[0], 60, 1e-9);
  EXPECT_EQ(m.last.target, e.to);
}

TEST(Follower, hold_brakes_in_the_next_cycle_rests_on_the_path_and_goes_on) {
  Machine m;
  m.planner.add(line_to(200, 0, 0, 100));
  m.planner.finish();
  for (int k = 0; k < 500; ++k) m.step();
  m.follower.hold();
  EXPECT_LT(m.step().acceleration[0], 0.0);
  EXPECT_EQ(m.last.state, FollowerState::holding);
  int cycles = 1;
  while (m.step().state == FollowerState::holding) ++cycles;
  EXPECT_EQ(m.last.state, FollowerState::held);
  EXPECT_NEAR(cycles, 200, 2);  // 100 / 1000 + 1000 / 10000 seconds
  const Vector there = m.last.position;
  for (int k = 0; k < 50; ++k) EXPECT_EQ(m.step().position, there);
  m.follower.resume();
  EXPECT_EQ(m.step().state, FollowerState::moving);
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_EQ(m.last.position[0], 200.0);
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
}

TEST(Follower, hold_is_as_quick_on_short_blocks_as_on_a_long_one) {
  Machine m;
  double x = 0, y = 0, heading = 0;
  for (int k = 0; k < 1500; ++k) {
    heading += 0.05 * std::sin(0.7 * k) + 0.03 * std::sin(0.11 * k);
    m.planner.add(line_to(x += 0.3 * std::cos(heading), y += 0.3 * std::sin(heading), 0, 100));
  }
  m.planner.finish();
  ASSERT_TRUE(m.until([](const Sample& s) { return s.position[0] > 150; }));
  const double speed = m.last.feed;
  EXPECT_GT(speed, 15.0);
  m.follower.hold();
  int cycles = 0;
  while (m.step().state == FollowerState::holding) ++cycles;
  EXPECT_EQ(m.last.state, FollowerState::held);
  // A tenth of the axes' acceleration and jerk is left for braking where the path takes the rest.
  EXPECT_LT(cycles, 1000 * (speed / 100.0 + 0.3));
  m.follower.resume();
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_NEAR(m.last.position[0], x, 1e-9);
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
}

TEST(Follower, override_zero_holds_and_every_ratio_scales_the_feed) {
  Machine m;
  m.planner.add(line_to(280, 0, 0, 50));
  m.planner.finish();
  for (const double ratio : {1.0, 0.3, 1.5, 0.0, 1.2, 2.0}) {
    m.follower.set_override(ratio);
    for (int k = 0; k < 600; ++k) m.step();
    EXPECT_NEAR(m.last.feed, 50 * std::min(ratio, 1.5), 1e-9) << ratio;
  }
  m.follower.set_override(0.0);
  EXPECT_TRUE(m.until(FollowerState::held));
  m.follower.set_override(1.0);
  EXPECT_TRUE(m.until(FollowerState::idle));
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
}

TEST(Follower, override_above_one_stays_inside_the_limits_and_leaves_rapids_alone) {
  Machine m;
  m.follower.set_override(1.5);
  Element rapid = line_to(250, 0, 0, 0);
  rapid.kind = Element::Kind::rapid;
  m.planner.add(rapid);
  m.planner.add(line_to(0, 0, 0, 480));
  m.planner.finish();
  double fastest = 0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    fastest = std::max(fastest, s.feed);
    return s.state == FollowerState::idle;
  }));
  EXPECT_LE(fastest, 500.0 + 1e-9);
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
}

TEST(Follower, an_exact_stop_waits_for_its_confirmation_only_where_asked) {
  Machine m;
  m.planner.add(stop_at(5, 0, false));
  m.planner.add(stop_at(10, 0, true));
  m.planner.add(stop_at(15, 0, false));
  m.planner.finish();
  ASSERT_TRUE(m.until(FollowerState::at_stop));
  EXPECT_EQ(m.last.position[0], 10.0);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(m.step().state, FollowerState::at_stop);
  m.follower.release_stop();
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_EQ(m.last.position[0], 15.0);
}

TEST(Follower, a_block_that_moves_nothing_and_stops_exactly_has_the_one_before_wait) {
  for (const bool course : {false, true}) {
    Machine m;
    if (course) m.planner.add(line_to(2, 1, 0, 100));
    m.planner.add(line_to(5, 0, 0, 100));
    m.planner.add(line_to(5, 0, 0, 100));
    m.planner.add(stop_at(5, 0, true));
    m.planner.add(line_to(10, 0, 0, 100));
    m.planner.finish();
    ASSERT_TRUE(m.until(FollowerState::at_stop)) << course;
    EXPECT_EQ(m.last.position[0], 5.0);
    m.follower.release_stop();
    ASSERT_TRUE(m.until(FollowerState::idle));
    EXPECT_EQ(m.last.position[0], 10.0);
  }
}

TEST(Follower, an_event_is_met_at_rest_and_waits) {
  Machine m;
  m.planner.add(line_to(5, 0, 0, 100));
  m.planner.add_event(42, {});
  m.planner.add_event(43, {});
  m.planner.add(line_to(10, 0, 0, 100));
  m.planner.finish();
  ASSERT_TRUE(m.until(FollowerState::at_event));
  EXPECT_EQ(m.last.event, 42u);
  EXPECT_EQ(m.last.position[0], 5.0);
  EXPECT_EQ(m.step().event, 42u);
  m.follower.release_event();
  EXPECT_EQ(m.step().event, 43u);
  m.follower.release_event();
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_EQ(m.last.position[0], 10.0);
  EXPECT_EQ(m.last.starved, 0u);
}

TEST(Follower, stop_comes_to_rest_on_the_path_drops_the_rest_and_a_restart_goes_on_from_there) {
  Machine m;
  for (int k = 1; k <= 50; ++k) m.planner.add(line_to(k * 5, k % 2, 0, 100));
  m.planner.finish();
  for (int k = 0; k < 400; ++k) m.step();
  m.follower.stop();
  ASSERT_TRUE(m.until(FollowerState::stopped));
  const Vector there = m.last.position;
  EXPECT_LT(there[0], 100.0);
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
  m.planner.restart(there);
  EXPECT_EQ(m.step().state, FollowerState::idle);
  EXPECT_EQ(m.last.position, there);
  m.planner.add(line_to(0, 0, 0, 100));
  m.planner.finish();
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_EQ(m.last.position, Vector{});
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
}

TEST(Follower, refuses_to_jump_to_a_path_that_starts_elsewhere) {
  Machine m;
  m.planner.restart({1, 0, 0});
  m.planner.add(line_to(10, 0, 0, 100));
  m.planner.finish();
  for (int k = 0; k < 10; ++k) EXPECT_EQ(m.step().state, FollowerState::fault);
  EXPECT_EQ(m.last.position, Vector{});
  m.planner.restart({});
  EXPECT_EQ(m.step().state, FollowerState::idle);
}

TEST(Follower, takes_a_position_only_at_standstill) {
  Machine m;
  EXPECT_TRUE(m.follower.set_position({1, 2, 3}));
  m.planner.restart({1, 2, 3});
  m.planner.add(line_to(10, 2, 3, 100));
  m.planner.finish();
  for (int k = 0; k < 20; ++k) m.step();
  EXPECT_FALSE(m.follower.set_position({}));
  m.follower.hold();
  ASSERT_TRUE(m.until(FollowerState::held));
  EXPECT_FALSE(m.follower.set_position({})) << "a path is begun";
}

TEST(Follower, late_planning_slows_down_on_the_path_is_counted_and_goes_on) {
  Machine m;
  for (int k = 1; k <= 3000; ++k) m.planner.add(line_to(k * 0.5, 3 * std::sin(k * 0.05), 0, 200));
  // The planner now falls silent without finish().
  ASSERT_TRUE(m.until([](const Sample& s) { return s.feed > 1.0; }));
  ASSERT_TRUE(m.until([](const Sample& s) { return s.feed == 0.0; }));
  EXPECT_GT(m.last.starved, 0u);
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
  for (int k = 3001; k <= 3010; ++k) m.planner.add(line_to(k * 0.5, 3 * std::sin(k * 0.05), 0, 200));
  m.planner.finish();
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_NEAR(m.last.position[0], 1505.0, 1e-6);
  EXPECT_LE(worst(m.trip, m.config).most(), 1.001);
}

TEST(Determinism, two_runs_are_equal_to_the_bit_and_a_replay_of_the_record_is_too) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const RandomProgram p = random_program(seed, {8, true, true});
    const Scenario s{seed, true, true, true, true, 1500};
    const Trip first = run(p, s), second = run(p, s), third = replay(p, first.record);
    ASSERT_EQ(first.samples.size(), second.samples.size());
    ASSERT_EQ(first.samples.size(), third.samples.size());
    for (std::size_t k = 0; k < first.samples.size(); ++k) {
      ASSERT_EQ(first.samples[k].position, second.samples[k].position) << seed;
      ASSERT_EQ(first.samples[k].position, third.samples[k].position) << seed << " cycle " << k;
      ASSERT_EQ(first.samples[k].starved, third.samples[k].starved);
    }
  }
}

TEST(Determinism, when_planning_is_pulled_does_not_show_unless_it_is_late) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RandomProgram p = random_program(seed, {8, true, false});
    Scenario lazy{seed};
    lazy.starving = true;
    const Trip a = run(p, {seed}), b = run(p, lazy);
    if (b.samples.back().starved != 0) continue;
    ++compared;
    // The lazy one starts later; from there on they are the same.
    std::size_t i = 0, j = 0;
    while (i < a.samples.size() && a.samples[i].feed == 0.0) ++i;
    while (j < b.samples.size() && b.samples[j].feed == 0.0) ++j;
    for (; i < a.samples.size() && j < b.samples.size(); ++i, ++j)
      ASSERT_EQ(a.samples[i].position, b.samples[j].position) << seed;
  }
  EXPECT_GT(compared, 10);
}

}  // namespace
}  // namespace servogate::path::test
