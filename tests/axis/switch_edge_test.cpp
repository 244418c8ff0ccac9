// SPDX-License-Identifier: Apache-2.0
// A home switch met by the time of its edge.
#include "kernel/axis/homing/switch_edge.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

using image::kMillisecond;
using image::Nanoseconds;
using test::Rig;

/// An axis that moves at 3 counts a millisecond and is latched every millisecond.
void pass(SwitchEdge& edge, int from_ms, int to_ms) {
  for (int t = from_ms; t <= to_ms; ++t) edge.sample(t * kMillisecond, 3 * t);
}

TEST(SwitchEdge, is_where_the_axis_was_between_two_latched_positions) {
  SwitchEdge edge;
  pass(edge, 0, 20);
  edge.edge(true, 10 * kMillisecond + kMillisecond / 3);
  edge.decide(true, 12 * kMillisecond);
  ASSERT_TRUE(edge.counts());
  EXPECT_EQ(*edge.counts(), 31);
}

TEST(SwitchEdge, waits_for_the_position_behind_it) {
  SwitchEdge edge;
  pass(edge, 0, 10);
  edge.edge(true, 11 * kMillisecond - kMillisecond / 3);
  edge.decide(true, 11 * kMillisecond);
  EXPECT_FALSE(edge.counts());
  pass(edge, 11, 11);
  ASSERT_TRUE(edge.counts());
  EXPECT_EQ(*edge.counts(), 32);
}

TEST(SwitchEdge, that_comes_later_than_its_level_counts_all_the_same) {
  SwitchEdge edge;
  pass(edge, 0, 12);
  edge.decide(true, 11 * kMillisecond);
  pass(edge, 13, 15);
  edge.edge(true, 10 * kMillisecond);
  ASSERT_TRUE(edge.counts());
  EXPECT_EQ(*edge.counts(), 30);
}

TEST(SwitchEdge, of_a_bouncing_contact_is_its_first_one) {
  SwitchEdge edge;
  pass(edge, 0, 60);
  for (int n = 0; n < 7; ++n) edge.edge(n % 2 == 0, 20 * kMillisecond + n * kMillisecond);
  edge.decide(true, 50 * kMillisecond);
  ASSERT_TRUE(edge.counts());
  EXPECT_EQ(*edge.counts(), 60);
}

TEST(SwitchEdge, of_another_change_or_of_a_later_one_is_not_it) {
  SwitchEdge edge;
  pass(edge, 0, 60);
  edge.edge(true, 10 * kMillisecond);
  edge.decide(false, 40 * kMillisecond);
  EXPECT_FALSE(edge.counts()) << "it led the other way";
  edge.edge(false, 70 * kMillisecond);
  pass(edge, 61, 120);
  EXPECT_FALSE(edge.counts()) << "it came long behind the cycle that saw the level";
  edge.decide(false, 55 * kMillisecond);
  ASSERT_TRUE(edge.counts()) << "of a cycle that is late";
  EXPECT_EQ(*edge.counts(), 210);
}

AxisConfig on_its_switch(bool edges, int release) {
  AxisConfig config = test::mill_axis();
  config.homing.method = HomingMethod::switch_only;
  config.homing.edges = edges;
  config.homing.release_direction = release;
  return config;
}

/// The counts that a homing takes for its position, the switch being at -250 mm.
std::int64_t captured(const AxisConfig& config, double start_mm, int bounces = 0) {
  Rig rig(config);
  rig.home_edges = config.homing.edges;
  rig.edge_bounces = bounces;
  rig.drive.start_at(std::llround(start_mm * 1000.0));
  EXPECT_TRUE(rig.enable() && rig.axis.home());
  EXPECT_TRUE(rig.run_until([&] { return !rig.axis.homing().active(); }));
  EXPECT_EQ(rig.axis.homing().state(), Homing::State::done) << rig.axis.homing().failure();
  EXPECT_TRUE(rig.events.empty());
  return rig.axis.reference_counts();
}

TEST(HomingByEdges, captures_the_place_of_its_switch_to_a_count_wherever_it_starts) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-309.0, 309.0);
  for (const int release : {-1, 1})
    for (int i = 0; i < 200; ++i)
      ASSERT_NEAR(static_cast<double>(captured(on_its_switch(true, release), start(random))), -250'000.0,
                  1.0);
}

TEST(HomingByEdges, is_not_moved_by_a_contact_that_bounces) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-240.0, 309.0);
  for (int i = 0; i < 100; ++i)
    ASSERT_NEAR(static_cast<double>(captured(on_its_switch(true, 1), start(random), 5)), -250'000.0, 1.0);
}

TEST(HomingByEdges, is_more_exact_than_by_the_level_of_a_cycle) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-240.0, 309.0);
  std::set<std::int64_t> by_level, by_edge;
  for (int i = 0; i < 200; ++i) {
    const double from = start(random);
    by_level.insert(captured(on_its_switch(false, 1), from));
    by_edge.insert(captured(on_its_switch(true, 1), from));
  }
  const auto spread = [](const std::set<std::int64_t>& s) { return *s.rbegin() - *s.begin(); };
  EXPECT_GE(spread(by_level), 2) << "3 mm/s, 1 ms, 1000 counts a millimetre";
  EXPECT_LE(spread(by_edge), 1);
}

TEST(HomingByEdges, says_when_no_edge_has_come_and_takes_the_level) {
  AxisConfig config = on_its_switch(true, 1);
  Rig rig(config);
  rig.drive.start_at(-200'000);
  ASSERT_TRUE(rig.enable() && rig.axis.home());
  EXPECT_TRUE(rig.run_until([&] { return !rig.axis.homing().active(); }));
  EXPECT_TRUE(rig.axis.homed());
  EXPECT_TRUE(rig.raised(alarm::kHomingNoEdge));
  EXPECT_NEAR(static_cast<double>(rig.axis.reference_counts()), -250'000.0, 7.0);
}

}  // namespace
}  // namespace servogate::axis
