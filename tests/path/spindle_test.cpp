// SPDX-License-Identifier: Apache-2.0
// Feed per revolution: the spindle's commanded speed is the master of the path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/path/rig/trip.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

constexpr double kTurns = 10.0;  // 1/s, what the elements are planned for

/// Planner and follower in one loop, as the virtual cycle runs them.
struct Turning {
  Turning() : track(mill()), planner(mill(), track), follower(mill(), track) {
    planner.restart({});
    trip.samples.emplace_back();
  }
  void add(const Element& e) { ASSERT_TRUE(planner.add(e)); }
  Sample step() {
    planner.work();
    trip.samples.push_back(follower.step(track.visible()));
    return trip.samples.back();
  }
  double feed_after(int cycles) {
    for (; cycles > 1; --cycles) step();
    return step().feed;
  }
  Track track;
  Planner planner;
  Follower follower;
  Trip trip;
};

Element turned(double x, double y, double feed) {
  Element e = line_to(x, y, 0, feed);
  e.revolutions = kTurns;
  return e;
}

TEST(Spindle, gives_the_feed_of_what_is_programmed_per_revolution_and_of_nothing_else) {
  Turning m;
  m.add(turned(100, 0, 50));
  m.add(line_to(200, 0, 0, 80));
  m.planner.finish();
  EXPECT_NEAR(m.feed_after(400), 50.0, 1e-9) << "nobody has told its speed: as planned";
  for (const double share : {0.5, 1.0, 1.2, 0.1}) {
    m.follower.set_spindle(kTurns * share);
    EXPECT_NEAR(m.feed_after(300), 50.0 * share, 1e-9) << share;
  }
  m.follower.set_spindle(kTurns);
  while (m.step().position[0] < 120.0) ASSERT_LT(m.trip.samples.size(), 10000u);
  m.follower.set_spindle(kTurns * 0.2);
  EXPECT_NEAR(m.feed_after(200), 80.0, 1e-9) << "feed per minute";
}

TEST(Spindle, and_override_together_reach_no_more_than_the_largest_override) {
  Turning m;
  m.add(turned(250, 0, 50));
  m.planner.finish();
  m.follower.set_override(1.5);
  m.follower.set_spindle(kTurns * 1.3);
  EXPECT_NEAR(m.feed_after(500), 75.0, 1e-9);
  m.follower.set_override(0.5);
  EXPECT_NEAR(m.feed_after(500), 50.0 * 0.5 * 1.3, 1e-9);
}

TEST(Spindle, at_rest_holds_the_path_without_a_hold_and_without_starving) {
  Turning m;
  m.add(turned(50, 0, 50));
  m.planner.finish();
  m.follower.set_spindle(0.0);
  for (int n = 0; n < 100; ++n) EXPECT_EQ(m.step().state, FollowerState::moving);
  EXPECT_TRUE(m.follower.waits_for_spindle());
  EXPECT_EQ(m.trip.samples.back().position, Vector{});
  m.follower.set_spindle(kTurns);
  EXPECT_NEAR(m.feed_after(400), 50.0, 1e-9);
  EXPECT_FALSE(m.follower.waits_for_spindle());
  m.follower.set_spindle(0.0);
  m.feed_after(300);
  EXPECT_TRUE(m.follower.waits_for_spindle());
  EXPECT_EQ(m.trip.samples.back().starved, 0u);
  m.follower.hold();
  EXPECT_EQ(m.step().state, FollowerState::held);
  EXPECT_FALSE(m.follower.waits_for_spindle());
  m.follower.stop();
  m.step();
  EXPECT_EQ(m.step().state, FollowerState::stopped);
}

TEST(Spindle, that_rests_is_reached_at_rest_from_a_block_with_feed_per_minute) {
  Turning m;
  m.add(line_to(50, 0, 0, 100));
  m.add(turned(100, 0, 100));
  m.planner.finish();
  m.follower.set_spindle(0.0);
  m.feed_after(1500);
  EXPECT_TRUE(m.follower.waits_for_spindle());
  EXPECT_NEAR(m.trip.samples.back().position[0], 50.0, 1e-9);
  EXPECT_LE(worst(m.trip, mill()).most(), 1.001);
}

/// A spindle whose speed wanders in every cycle, stops and starts again.
void wander(std::uint64_t first, int programs, double share_turned) {
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(programs); ++seed) {
    RandomProgram program = random_program(seed, {8, true, false});
    std::mt19937_64 random(seed);
    const auto chance = [&](double p) { return std::uniform_real_distribution<>()(random) < p; };
    for (Element& e : program.elements)
      if (e.kind != Element::Kind::rapid && chance(share_turned))
        e.revolutions = kTurns * (chance(0.5) ? 1.0 : 2.0);
    Track track(program.config);
    Planner planner(program.config, track);
    Follower follower(program.config, track);
    follower.set_position(program.start);
    planner.restart(program.start);
    Trip trip;
    trip.samples.emplace_back();
    trip.samples.back().position = program.start;
    double turns = kTurns, wanted = kTurns;
    std::size_t next = 0;
    bool finished = false;
    for (int cycle = 0; cycle < 400000 && !trip.ended; ++cycle) {
      while (!finished && planner.wants_more()) {
        if (next < program.elements.size()) {
          ASSERT_TRUE(planner.add(program.elements[next++])) << seed;
        } else {
          planner.finish();
          finished = true;
        }
        planner.work();
      }
      planner.work();
      if (chance(0.005))
        wanted = cycle > 3000 ? kTurns : chance(0.3) ? 0.0 : 2.5 * kTurns * (random() % 1000) / 1000.0;
      turns += std::clamp(wanted - turns, -0.05, 0.05);
      follower.set_spindle(turns);
      trip.samples.push_back(follower.step(track.visible()));
      follower.release_stop();
      trip.ended = finished && trip.samples.back().state == FollowerState::idle;
    }
    ASSERT_EQ(verdict(trip, program), "") << "seed " << seed;
  }
}

TEST(Spindle, keeps_every_law_while_its_speed_changes_in_every_cycle) {
  const std::uint64_t seed = servogate::test::property_seed();
  wander(seed, 40, 1.0);
  wander(seed, 30, 0.7);
}

}  // namespace
}  // namespace servogate::path::test
