// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/planner.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

#include "kernel/path/follower.hpp"
#include "tests/comes.hpp"
#include "tests/path/rig/trip.hpp"

namespace servogate::path::test {
namespace {

using Program = std::vector<Element>;

/// Speed of the set-point where it passes nearest to `place`.
double speed_at(const Program& elements, const Vector& place) {
  RandomProgram p;
  p.config = mill();
  p.elements = elements;
  const Trip trip = run(p, {});
  double nearest = 1e9, feed = -1;
  for (const Sample& s : trip.samples) {
    const double d = std::hypot(s.position[0] - place[0], s.position[1] - place[1]);
    if (d < nearest) {
      nearest = d;
      feed = s.feed;
    }
  }
  return feed;
}

Element limited(double x, double y, double feed, double erf, double max_angle_deg) {
  Element e = line_to(x, y, 0, feed);
  e.transition = {Continuation::corner_limited, 0.01, erf, max_angle_deg, false};
  return e;
}

TEST(Planner, a_line_takes_the_time_of_its_s_curve) {
  // 100 mm at 1000 mm/s2 and 10 000 mm/s3 peak at 270.2 mm/s: 2 (0.2702 + 0.1) s.
  const Program p{line_to(100, 0, 0, 500)};
  EXPECT_NEAR(estimate(mill(), {}, p).seconds, 0.7403, 0.0015);
}

TEST(Planner, a_thousand_collinear_blocks_take_the_time_of_one) {
  for (const double feed : {100.0, 500.0}) {
    Program one{line_to(60, 80, 0, feed)}, many;
    for (int k = 1; k <= 1000; ++k) many.push_back(line_to(0.06 * k, 0.08 * k, 0, feed));
    const double alone = estimate(mill(), {}, one).seconds;
    // A course leaves a hundredth of the limits for changes of rate.
    EXPECT_NEAR(estimate(mill(), {}, many).seconds, alone, 0.01 * alone);
  }
}

TEST(Planner, estimate_gives_extents_and_names_the_element_that_cannot_be_driven) {
  Program p{line_to(10, 0, 0, 50), arc_to(20, 0, 15, 0, -180, 50), line_to(20, -3, -2, 50)};
  Estimate e = estimate(mill(), {}, p);
  EXPECT_NEAR(e.highest[1], 5, 0.01);
  EXPECT_NEAR(e.lowest[1], -3, 1e-12);
  EXPECT_EQ(e.lowest[2], -2);
  EXPECT_EQ(e.flawed, 0u);
  p.push_back(arc_to(30, 0, 24, 0, 180, 50));
  e = estimate(mill(), {}, p);
  EXPECT_EQ(e.flawed, 4u);
  EXPECT_EQ(e.flaw, Flaw::radius);
}

TEST(Planner, an_element_that_cannot_be_driven_changes_nothing) {
  const Config config = mill();
  Track track(config);
  Planner planner(config, track);
  planner.restart({});
  EXPECT_TRUE(planner.add(line_to(10, 0, 0, 50)));
  EXPECT_FALSE(planner.add(line_to(20, 0, 0, -1)));
  EXPECT_EQ(planner.last_flaw(), Flaw::no_feed);
  EXPECT_EQ(planner.position(), (Vector{10, 0, 0}));
}

TEST(Planner, zero_override_in_an_estimate_does_not_hang) {
  EXPECT_GT(estimate(mill(), {}, Program{line_to(0.01, 0, 0, 100)}, 0.0).seconds, 0.05);
}

TEST(Planner, passes_a_corner_with_the_tolerance_and_stops_without) {
  Program p{line_to(20, 0, 0, 100, 0.05), line_to(20, 20, 0, 100, 0.05)};
  EXPECT_GT(speed_at(p, {20, 0, 0}), 2.0);
  p[0].transition.tolerance = 0.0;
  EXPECT_LT(speed_at(p, {20, 0, 0}), 0.5);
  p[0].transition = {Continuation::exact_stop, 0.05, 0, 180, false};
  EXPECT_LT(speed_at(p, {20, 0, 0}), 0.5);
}

TEST(Planner, a_tangential_joint_of_line_and_arc_is_not_stopped_at) {
  const Program p{line_to(30, 0, 0, 50), arc_to(50, 20, 30, 20, 90, 50), line_to(50, 50, 0, 50)};
  EXPECT_GT(speed_at(p, {30, 0, 0}), 30.0);
  EXPECT_GT(speed_at(p, {50, 20, 0}), 30.0);
}

TEST(Planner, corner_rule_bounds_the_corner_speed) {
  // v2 = a ERF s / (1 - s), s = cos(alpha / 2): 20 degrees, ERF 0.0001: 2.545 mm/s.
  const double alpha = 20.0 / 180.0 * std::numbers::pi;
  const Program p{limited(20, 0, 100, 0.0001, 180),
                  limited(20 + 20 * std::cos(alpha), 20 * std::sin(alpha), 100, 0.0001, 180)};
  const double s = std::cos(0.5 * alpha), v = std::sqrt(1000 * 0.0001 * s / (1 - s));
  EXPECT_LE(speed_at(p, {20, 0, 0}), v * (1 + 1e-6));
  EXPECT_GE(speed_at(p, {20, 0, 0}), 0.9 * v);
}

TEST(Planner, corner_rule_stops_with_erf_zero_even_on_a_straight_line_and_beyond_the_largest_angle) {
  const Program straight{limited(50, 0, 100, 0.0, 180), limited(100, 0, 100, 0.0, 180)};
  EXPECT_LT(speed_at(straight, {50, 0, 0}), 0.5);
  const Program bent{limited(20, 0, 100, 0.1, 30), limited(40, 20, 100, 0.1, 30)};
  EXPECT_LT(speed_at(bent, {20, 0, 0}), 0.5);
  const Program inside{limited(20, 0, 100, 0.1, 60), limited(40, 20, 100, 0.1, 60)};
  EXPECT_GT(speed_at(inside, {20, 0, 0}), 1.0);
}

TEST(Planner, a_way_back_on_itself_stops_in_the_end_point) {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  p.elements = {line_to(10, 0, 0, 100), line_to(0, 0, 0, 100), line_to(0, 1e-3, 0, 100)};
  const Trip trip = run(p, {});
  EXPECT_EQ(verdict(trip, p), "");
  double furthest = 0;
  for (const Sample& s : trip.samples) furthest = std::max(furthest, s.position[0]);
  EXPECT_NEAR(furthest, 10.0, 1e-6);
}

TEST(Planner, blocks_of_a_nanometre_and_of_ten_metres_and_none_at_all) {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  for (int k = 1; k <= 2000; ++k) p.elements.push_back(line_to(1e-6 * k, 0, 0, 100));
  p.elements.push_back(p.elements.back());
  p.elements.push_back(line_to(10000, 0, 0, 500));
  p.elements.push_back(line_to(10000, 0, 0, 500));
  p.elements.push_back(line_to(10000, 1e-6, 0, 500));
  EXPECT_EQ(verdict(run(p, {}), p), "");
}

TEST(Planner, a_program_that_fills_the_track_many_times_runs_through) {
  RandomProgram p;
  p.config = mill();
  p.config.piece_capacity = 1024;
  p.tolerance = 0.01;
  for (int k = 1; k <= 20000; ++k)
    p.elements.push_back(line_to(0.05 * k, 0.3 * std::sin(0.02 * k), 0.1 * std::cos(0.05 * k), 60));
  const Trip trip = run(p, {}, 2000000);
  EXPECT_EQ(verdict(trip, p), "");
  EXPECT_EQ(trip.samples.back().starved, 0u);
}

TEST(Planner, exact_stops_in_great_number_do_not_starve) {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  for (int k = 1; k <= 3000; ++k) {
    p.elements.push_back(line_to(0.001 * k, 0, 0, 60));
    p.elements.back().transition.continuation = Continuation::exact_stop;
  }
  const Trip trip = run(p, {});
  EXPECT_EQ(verdict(trip, p), "");
  EXPECT_EQ(trip.samples.back().starved, 0u);
}

TEST(Planner, works_beside_the_cycle_in_a_thread_of_its_own) {
  const RandomProgram p = random_program(99, {300, false, false});
  Track track(p.config);
  Planner planner(p.config, track);
  Follower follower(p.config, track);
  follower.set_position(p.start);
  std::atomic<bool> done{false};
  std::thread planning([&] {
    planner.restart(p.start);
    for (const Element& e : p.elements) {
      while (!planner.wants_more()) {
        planner.work();
        std::this_thread::yield();
      }
      planner.add(e);
      planner.work();
    }
    planner.finish();
    while (!done) {
      planner.work();
      std::this_thread::yield();
    }
  });
  Trip trip;
  trip.samples.emplace_back();
  trip.samples.back().position = p.start;
  const auto near_end = [&](const Sample& s) {
    for (int i = 0; i < p.config.axis_count; ++i)
      if (std::abs(s.position[i] - p.elements.back().to[i]) > 1e-6) return false;
    return true;
  };
  // However late a busy computer plans: who follows waits for it at rest.
  EXPECT_TRUE(tests::comes(
      [&] {
        do trip.samples.push_back(follower.step(track.visible()));
        while (trip.samples.back().state == FollowerState::moving && trip.samples.size() < 3'000'000);
        return near_end(trip.samples.back());
      },
      std::chrono::milliseconds(1)));
  done = true;
  planning.join();
  trip.ended = near_end(trip.samples.back());
  EXPECT_EQ(verdict(trip, p), "");
}

}  // namespace
}  // namespace servogate::path::test
