// SPDX-License-Identifier: Apache-2.0
// The law over one clock as the follower drives it: holds, overrides, stops, late planning, and which runs
// it drives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "kernel/path/path_time.hpp"
#include "tests/path/rig/driven_path.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Machine : DrivenPath {
  explicit Machine(const Config& c = mill()) : DrivenPath(c) {}
};

std::vector<Element> circle(int blocks, double feed) {
  std::vector<Element> e;
  for (int i = 1; i <= blocks; ++i) {
    const double a = 2 * kPi * i / blocks;
    e.push_back(line_to(20 - 20 * std::cos(a), 20 * std::sin(a), 0, feed));
    e.back().tag.line = i;
  }
  return e;
}

std::vector<Element> wave(int blocks, double feed) {
  std::vector<Element> e;
  for (int k = 1; k <= blocks; ++k) e.push_back(line_to(k * 0.3, 3 * std::sin(k * 0.05), 0, feed));
  return e;
}

void load(Machine& m, const std::vector<Element>& elements) {
  for (const Element& e : elements) ASSERT_TRUE(m.planner.add(e));
  m.planner.finish();
}

TEST(DrivenCourse, of_a_circle_in_a_thousand_blocks_takes_what_is_known_to_be_the_least) {
  EXPECT_LE(estimate(mill(), {}, circle(1000, 100)).seconds, 1.475);  // ideal 1.457
  EXPECT_LE(estimate(mill(), {}, std::vector{arc_to(0, 0, 20, 0, 360, 100)}).seconds, 1.475) << "one arc";
}

TEST(DrivenCourse, is_chosen_for_two_elements_and_more_and_for_an_arc_that_needs_its_axes) {
  const auto courses = [](const std::vector<Element>& elements, Config config) {
    Track track(config);
    Planner planner(config, track);
    planner.restart({});
    for (const Element& e : elements) planner.add(e);
    planner.finish();
    planner.work();
    int n = 0;
    for (std::uint64_t k = 0; k < track.entries.written(); ++k)
      n += track.entries[k].kind == Entry::Kind::course ? 1 : 0;
    return n;
  };
  const std::vector<Element> square{line_to(80, 0, 0, 50), line_to(80, 80, 0, 50), line_to(0, 80, 0, 50)};
  EXPECT_EQ(courses(circle(100, 100), mill()), 1);
  EXPECT_EQ(courses(square, mill()), 1);
  EXPECT_EQ(courses({square[0]}, mill()), 0) << "a line from rest to rest";
  EXPECT_EQ(courses({arc_to(0, 0, 20, 0, 360, 100)}, mill()), 1) << "an arc that needs half the acceleration";
  EXPECT_EQ(courses({arc_to(0, 0, 60, 0, 360, 100)}, mill()), 0);
  std::vector<Element> turned = circle(100, 100);
  for (Element& e : turned) e.revolutions = 10.0;
  EXPECT_EQ(courses(turned, mill()), 1) << "feed per revolution";
  for (std::size_t k = 50; k < turned.size(); ++k) turned[k].revolutions = 0.0;
  EXPECT_EQ(courses(turned, mill()), 2) << "with a rest where the feed is another";
}

TEST(DrivenCourse, goes_through_more_blocks_in_a_few_knots_than_the_track_has_room_for) {
  for (const double length : {1e-6, 1e-4, 1e-3}) {
    Machine m;
    std::vector<Element> elements{line_to(10, 0, 0, 100)};
    for (int k = 1; k <= 30000; ++k) elements.push_back(line_to(10 + k * length, 0, 0, 100));
    elements.push_back(line_to(60, 0, 0, 100));
    for (std::size_t n = 0; n < elements.size(); ++n) elements[n].tag.line = static_cast<std::int32_t>(n) + 1;
    load(m, elements);
    std::int32_t line = 0;
    m.trip.ended = m.until([&](const Sample& s) {
      EXPECT_GE(s.tag.line, line);
      line = std::max(line, s.tag.line);
      return s.state == FollowerState::idle;
    });
    EXPECT_TRUE(m.trip.ended) << length << ", in line " << line;
    EXPECT_EQ(line, 30002);
    EXPECT_NEAR(m.last.position[0], 60.0, 1e-9);
    EXPECT_EQ(m.last.starved, 0u) << length;
  }
}

TEST(DrivenCourse, holds_in_the_next_cycle_rests_on_the_path_and_goes_on) {
  for (const int at : {300, 617, 1001, 1600}) {
    Machine m;
    load(m, wave(800, 100));
    for (int k = 0; k < at; ++k) m.step();
    const double before = m.last.feed;
    m.follower.hold();
    m.step();
    EXPECT_EQ(m.last.state, FollowerState::holding);
    int cycles = 1;
    while (m.step().state == FollowerState::holding) ++cycles;
    EXPECT_EQ(m.last.state, FollowerState::held);
    EXPECT_EQ(m.last.feed, 0.0);
    EXPECT_TRUE(m.follower.at_rest());
    EXPECT_GT(before, 20.0);
    EXPECT_LE(cycles, 1200);
    const Vector there = m.last.position;
    EXPECT_NEAR(there[1], 3 * std::sin(there[0] / 6), 0.02);
    for (int k = 0; k < 50; ++k) EXPECT_EQ(m.step().position, there);
    m.follower.resume();
    ASSERT_TRUE(m.until(FollowerState::idle));
    EXPECT_EQ(m.last.starved, 0u);
    EXPECT_NEAR(m.last.position[0], 240.0, 1e-9);
    EXPECT_LE(m.most(), 1.001);
  }
}

TEST(DrivenCourse, is_held_sooner_at_a_lower_override) {
  for (const double ratio : {0.01, 0.1, 0.5}) {
    Machine m;
    m.follower.set_override(ratio);
    load(m, wave(800, 100));
    for (int k = 0; k < 3000; ++k) m.step();
    m.follower.hold();
    int cycles = 0;
    while (m.step().state == FollowerState::holding) ++cycles;
    EXPECT_LE(cycles, 60 + 700 * std::sqrt(ratio)) << ratio;
    EXPECT_LE(m.most(), 1.001) << ratio;
  }
}

TEST(DrivenCourse, is_held_in_a_cruise_and_before_and_behind_it) {
  for (int at = 100; at < 4600; at += 190) {
    Machine m;
    load(m, {line_to(80, 0, 0, 50), line_to(80, 90, 0, 50), line_to(70, 90, 0, 50)});
    for (int k = 0; k < at && m.last.state != FollowerState::idle; ++k) m.step();
    m.follower.hold();
    for (int k = 0; k < 1500; ++k) m.step();
    EXPECT_EQ(m.last.feed, 0.0) << at;
    m.follower.resume();
    ASSERT_TRUE(m.until(FollowerState::idle)) << at;
    EXPECT_NEAR(m.last.position[0], 70.0, 1e-9);
    EXPECT_LE(m.most(), 1.001) << at;
  }
}

/// A line, three turns of 20 mm, and a line on.
std::vector<Element> helix(double feed) {
  Element turns = arc_to(30, 0, 30, 20, 3 * 360, feed);
  turns.to[2] = -6;
  return {line_to(30, 0, 0, feed), turns, line_to(60, 0, -6, feed)};
}

TEST(DrivenCourse, of_a_helix_is_planned_at_its_ends_alone_and_keeps_to_it_in_the_middle) {
  Machine m;
  load(m, helix(40));
  m.planner.work();
  const double seconds = 437.0 / 40.0;
  EXPECT_LE(m.track.knots.written(), 0.3 * seconds / 0.004) << "of the knots that a law needs";
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_LE(m.most(), 1.001);
  double off = 0.0;
  int seen = 0;
  for (const Sample& s : m.trip.samples) {
    if (s.position[2] > -0.5 || s.position[2] < -5.5) continue;
    ++seen;
    off = std::max(off, std::abs(std::hypot(s.position[0] - 30, s.position[1] - 20) - 20));
    EXPECT_NEAR(s.feed, 40.0, 0.05);
  }
  EXPECT_GE(seen, 7000);
  EXPECT_LE(off, 1e-5) << "mm, of 1.5 um that are allowed";
  EXPECT_NEAR(m.last.position[0], 60.0, 1e-9);
}

TEST(DrivenCourse, of_a_helix_is_held_at_once_and_goes_on) {
  for (int at = 300; at < 11000; at += 893) {
    Machine m;
    load(m, helix(40));
    for (int k = 0; k < at; ++k) m.step();
    m.follower.hold();
    int cycles = 1;
    while (m.step().state == FollowerState::holding) ++cycles;
    EXPECT_LE(cycles, 250) << at;
    m.follower.set_override(0.6);
    m.follower.resume();
    for (int k = 0; k < 800; ++k) m.step();
    m.follower.set_override(1.3);
    ASSERT_TRUE(m.until(FollowerState::idle)) << at;
    EXPECT_NEAR(m.last.position[0], 60.0, 1e-9);
    EXPECT_LE(m.most(), 1.001) << at;
  }
}

TEST(DrivenCourse, above_a_hundred_per_cent_on_an_arc_is_held_within_160_ms_and_soon_rests) {
  double way = 0.0;
  int holds = 0, longest = 0;
  for (int change = 1000; change < 3000; change += 487)
    for (const int after : {20, 60, 100, 300, 700}) {
      Machine m;
      for (int k = 0; k < 8; ++k) ASSERT_TRUE(m.planner.add(arc_to(0, 0, 60, 0, 360, 100)));
      m.planner.finish();
      for (int k = 0; k < change; ++k) m.step();
      m.follower.set_override(1.5);
      for (int k = 0; k < after; ++k) m.step();
      m.follower.hold();
      int waits = 0;
      double feed = m.last.feed;
      for (bool slower = false; m.step().state == FollowerState::holding; feed = m.last.feed) {
        slower = slower || m.last.feed < feed - 1e-6;
        waits += slower ? 0 : 1;
        way += 0.001 * m.last.feed;
      }
      EXPECT_EQ(m.last.state, FollowerState::held);
      EXPECT_LE(m.most(), 1.001) << change << " " << after;
      longest = std::max(longest, waits);
      ++holds;
    }
  EXPECT_LE(longest, 160);
  EXPECT_LT(way / holds, 26.0) << "a line would take 18.75 mm from 150 mm/s";
}

TEST(DrivenCourse, follows_every_override_where_the_feed_is_what_binds) {
  Machine m;
  std::vector<Element> blocks;
  for (int k = 1; k <= 2000; ++k) blocks.push_back(line_to(0.3 * k, 0, 0, 50));
  load(m, blocks);
  for (const double ratio : {1.0, 0.3, 1.5, 0.0, 1.2, 2.0, 0.8}) {
    m.follower.set_override(ratio);
    for (int k = 0; k < 1200; ++k) m.step();
    EXPECT_NEAR(m.last.feed, 50 * std::min(ratio, 1.5), 0.003 * 75) << ratio;
  }
  m.follower.set_override(1.0);
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_NEAR(m.last.position[0], 600.0, 1e-9);
  EXPECT_LE(m.most(), 1.001);
}

TEST(DrivenCourse, above_a_hundred_per_cent_is_as_fast_as_the_limits_let_it_be) {
  for (const double ratio : {1.0, 1.5}) {
    Machine m;
    m.follower.set_override(ratio);
    load(m, wave(800, 40));
    ASSERT_TRUE(m.until(FollowerState::idle));
    EXPECT_LE(m.most(), 1.001);
    const double seconds = 0.001 * static_cast<double>(m.trip.samples.size());
    if (ratio > 1.0)
      EXPECT_LE(seconds, 5.6);
    else
      EXPECT_GE(seconds, 6.4);
  }
}

TEST(DrivenCourse, keeps_its_limits_at_any_override_where_everything_binds_by_turns) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Machine m;
    std::mt19937_64 random(seed);
    std::vector<Element> rows;
    for (int r = 0; r < 4; ++r)
      for (int i = 0; i < 101; ++i) {
        const double x = 0.4 * (r % 2 == 0 ? i : 100 - i), z = 0.5 * std::sin(x / 5 + 0.2 * r);
        rows.push_back(line_to(x, 0.5 * r, z, seed % 2 == 0 ? 60 : 100));
      }
    load(m, rows);
    m.follower.set_override(1.5);
    for (int k = 0; k < 60000 && (k < 10 || m.last.state != FollowerState::idle); ++k) {
      if (seed > 2 && random() % 200 == 0)
        m.follower.set_override(0.1 * static_cast<double>(3 + random() % 13));
      m.step();
    }
    EXPECT_EQ(m.last.state, FollowerState::idle) << seed;
    EXPECT_LE(m.most(), 1.001) << seed;
  }
}

TEST(DrivenCourse, stops_drops_the_rest_and_a_restart_goes_on_from_there) {
  Machine m;
  load(m, wave(3000, 100));
  for (int k = 0; k < 900; ++k) m.step();
  m.follower.stop();
  ASSERT_TRUE(m.until(FollowerState::stopped));
  const Vector there = m.last.position;
  EXPECT_LE(m.most(), 1.001);
  m.planner.restart(there);
  EXPECT_EQ(m.step().state, FollowerState::idle);
  EXPECT_EQ(m.last.position, there);
  for (int k = 1; k <= 50; ++k) m.planner.add(line_to(there[0] + 0.2 * k, there[1], 0, 100));
  m.planner.finish();
  ASSERT_TRUE(m.until(FollowerState::idle));
  EXPECT_NEAR(m.last.position[0], there[0] + 10.0, 1e-9);
  EXPECT_LE(m.most(), 1.001);
}

TEST(DrivenCourse, slows_down_on_the_path_where_planning_is_late_and_never_leaves_what_is_known) {
  RandomProgram p;
  p.config = mill();
  p.tolerance = 0.01;
  p.elements = wave(2500, 100);
  for (const int cycles : {3, 6, 12}) {  // for an element that takes three
    Machine m;
    std::size_t next = 0;
    std::vector<std::uint64_t> seen;
    for (int k = 0; k < 100000 && !m.trip.ended; ++k) {
      if (k % cycles == 0 && next < p.elements.size()) m.planner.add(p.elements[next++]);
      if (next == p.elements.size()) m.planner.finish(), ++next;
      m.step();
      seen.push_back(m.track.visible());
      m.trip.ended = next > p.elements.size() && m.last.state == FollowerState::idle;
    }
    EXPECT_EQ(verdict(m.trip, p), "") << cycles;
    if (cycles > 3) {
      EXPECT_GT(m.last.starved, 100u);
    }

    Machine again;
    for (const Element& e : p.elements) again.planner.add(e);
    again.planner.finish();
    for (std::size_t k = 0; k < seen.size(); ++k) {
      again.planner.work();
      ASSERT_EQ(again.follower.step(seen[k]).position, m.trip.samples[k + 1].position) << cycles << ' ' << k;
    }
  }
}

TEST(DrivenCourse, begins_when_some_seconds_of_its_motion_are_known_however_slow_it_is) {
  std::vector<Element> zigzag, line;
  for (int k = 1; k <= 2000; ++k) {
    zigzag.push_back(line_to(0.1 * ((k + 1) / 2), 0.1 * (k / 2), 0, 100));  // reaches 3 mm/s
    line.push_back(line_to(0.1 * k, 0, 0, 20));
  }
  for (const std::vector<Element>& elements : {zigzag, line, wave(2000, 100)}) {
    Machine m;
    PathTime known(m.config, {});
    for (std::size_t n = 0; m.last.feed == 0.0; ++n) {
      ASSERT_LT(n, elements.size());
      ASSERT_TRUE(m.planner.add(elements[n]));
      known.add(elements[n]);
      m.step();
    }
    known.rest();
    EXPECT_LT(known.seconds(), 9.0);
  }
}

/// Speed of the set-point where it passes nearest to (20, 0), from a line along the first axis to one turned
/// by `alpha`.
double speed_at_corner(double alpha, double erf, double max_angle_deg) {
  Machine m;
  Element e = line_to(20, 0, 0, 100);
  e.transition = {Continuation::corner_limited, 0.01, erf, max_angle_deg, false};
  m.planner.add(e);
  e.to = {20 + 20 * std::cos(alpha), 20 * std::sin(alpha)};
  m.planner.add(e);
  m.planner.finish();
  double nearest = 1e9, feed = -1;
  EXPECT_TRUE(m.until([&](const Sample& s) {
    const double d = std::hypot(s.position[0] - 20, s.position[1]);
    if (d < nearest) nearest = d, feed = s.feed;
    return s.state == FollowerState::idle;
  }));
  EXPECT_LE(m.most(), 1.001);
  return feed;
}

TEST(DrivenCourse, keeps_the_corner_speed_of_the_corner_rule_and_stops_beyond_its_largest_angle) {
  // v2 = a ERF s / (1 - s), s = cos(alpha / 2): 20 degrees, ERF 0.0001: 2.545 mm/s.
  const double alpha = 20.0 / 180.0 * kPi, s = std::cos(0.5 * alpha);
  const double v = std::sqrt(1000 * 0.0001 * s / (1 - s));
  EXPECT_LE(speed_at_corner(alpha, 0.0001, 180), v * (1 + 1e-3));
  EXPECT_GE(speed_at_corner(alpha, 0.0001, 180), 0.85 * v);
  EXPECT_GE(speed_at_corner(alpha, 0.1, 180), 2 * v);
  EXPECT_LT(speed_at_corner(alpha, 0.1, 15), 0.5);
}

TEST(DrivenCourse, reaches_the_end_point_of_a_way_back_on_itself) {
  Machine m;
  load(m, {line_to(10, 0, 0, 100), line_to(0, 0, 0, 100), line_to(3, 4, 0, 100)});
  double furthest = 0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    furthest = std::max(furthest, s.position[0]);
    return s.state == FollowerState::idle;
  }));
  EXPECT_NEAR(furthest, 10.0, 1e-6);
}

TEST(DrivenCourse, shows_each_block_in_turn_and_what_is_left_of_it) {
  Machine m;
  load(m, circle(60, 30));
  int line = 0;
  ASSERT_TRUE(m.until([&](const Sample& s) {
    if (s.state == FollowerState::idle) return true;
    EXPECT_GE(s.tag.line, line);
    EXPECT_LE(s.tag.line, line + 1);
    line = std::max(line, s.tag.line);
    EXPECT_NEAR(s.distance_to_go, std::hypot(s.target[0] - s.position[0], s.target[1] - s.position[1]),
                0.021);
    return false;
  }));
  EXPECT_EQ(line, 60);
}

TEST(DrivenCourse, gives_velocity_and_acceleration_of_its_set_points) {
  Machine m;
  load(m, circle(400, 100));
  m.follower.set_override(0.8);
  for (int k = 0; k < 800; ++k) m.step();
  const std::vector<Sample>& s = m.trip.samples;
  for (std::size_t k = 2; k + 1 < s.size(); ++k)
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(s[k].velocity[i], (s[k + 1].position[i] - s[k - 1].position[i]) * 500, 0.02) << k;
      EXPECT_NEAR(s[k].acceleration[i],
                  (s[k + 1].position[i] - 2 * s[k].position[i] + s[k - 1].position[i]) * 1e6, 6.0)
          << k;
    }
}

TEST(DrivenCourse, is_held_in_the_middle_of_a_long_line_as_soon_as_at_any_constant_speed) {
  for (const double length : {200.0, 400.0, 1000.0}) {
    Machine m(mill());
    load(m, {line_to(length, 0, 0, 100), line_to(length, length, 0, 100)});
    for (int k = 0; k < 600; ++k) m.step();
    EXPECT_NEAR(m.last.feed, 100.0, 0.5);
    m.follower.hold();
    int cycles = 0;
    while (m.step().state == FollowerState::holding) ++cycles;
    EXPECT_LT(cycles, 450) << "not at the end of the line, " << length << " mm long";
    EXPECT_LE(m.most(), 1.001);
    m.follower.resume();
    ASSERT_TRUE(m.until(FollowerState::idle)) << length;
    EXPECT_NEAR(m.last.position[1], length, 1e-9);
  }
}

TEST(DrivenCourse, stops_sooner_and_takes_longer_with_a_greater_reserve) {
  double stop = 10.0, whole = 0.0;
  for (const double reserve : {0.01, 0.2}) {
    Config config = mill();
    config.reserve = reserve;
    Machine m(config);
    load(m, circle(1000, 200));  // at the limit of acceleration
    for (int k = 0; k < 600; ++k) m.step();
    m.follower.hold();
    int cycles = 0;
    while (m.step().state == FollowerState::holding) ++cycles;
    EXPECT_LT(0.001 * cycles, 0.8 * stop);
    stop = 0.001 * cycles;
    const double seconds = estimate(config, {}, circle(1000, 200)).seconds;
    EXPECT_GT(seconds, 1.03 * whole);
    whole = seconds;
    EXPECT_LE(m.most(), 1.001);
  }
}

}  // namespace
}  // namespace servogate::path::test
