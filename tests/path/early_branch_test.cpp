// SPDX-License-Identifier: Apache-2.0
// Holds and overrides below 100 % along lines of a course: at once, and as fast as the axes can.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "kernel/path/law/rate_motion.hpp"
#include "kernel/path/law/s_curve.hpp"
#include "tests/path/rig/course.hpp"
#include "tests/path/rig/driven_path.hpp"
#include "tests/path/rig/published_course.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

constexpr double kLine = 260.0, kFeed = 100.0, kCycle = 0.001;

RandomProgram program(const std::vector<Element>& elements, const Config& config = mill()) {
  RandomProgram p;
  p.config = config;
  p.tolerance = 0.01;
  p.elements = elements;
  return p;
}

/// A line along the first axis, of which the last part is slower, a corner, two more lines.
std::vector<Element> lines(double corner_x, double corner_y) {
  return {line_to(kLine - 60, 0, 0, kFeed), line_to(kLine, 0, 0, 0.4 * kFeed),
          line_to(kLine + corner_x, corner_y, 0, kFeed), line_to(0, corner_y, 0, kFeed)};
}

/// A motion along a course that is known; copies of it try what might be asked.
struct Along {
  explicit Along(const PublishedCourse& c) : course(&c), motion(c.limits) {}
  bool step(double target) {
    const bool on = motion.step(*course, target, kCycle);
    point = motion.point(*course);
    return on;
  }
  double speed() const { return std::hypot(point.v[0], point.v[1], point.v[2]); }
  /// The fastest change from here to a speed along the first axis.
  Profile fastest(double speed) const {
    const AxisLimits& x = course->limits.limits[0];
    Profile ramp;
    ramp.start({point.x[0], point.v[0], point.a[0]});
    add_ramp(ramp, point.v[0], point.a[0], speed, {x.velocity, x.acceleration, x.jerk});
    return ramp;
  }
  int least_cycles(double speed) const {
    return static_cast<int>(std::ceil(fastest(speed).duration() / kCycle));
  }
  /// Cycles until it rests.
  int hold() {
    int cycles = 0;
    while (!motion.at_rest() && cycles < 10000) {
      step(0.0);
      ++cycles;
    }
    return cycles;
  }
  const PublishedCourse* course;
  RateMotion motion;
  CoursePoint point;
};

TEST(EarlyBranch, holds_on_a_line_in_the_least_time_while_it_speeds_up_cruises_and_slows_down) {
  const PublishedCourse course(program(lines(0, 30)));
  ASSERT_TRUE(course.whole());
  int speeding = 0, slowing = 0;
  Along along(course);
  for (int k = 0; k < 20; ++k) along.step(1.0);
  for (; along.fastest(0.0).end().s < kLine - 0.5;
       along.step(1.0)) {  // its stop does not lead into the corner
    Along held = along;
    const double a = along.point.a[0];
    speeding += a > 50.0 ? 1 : 0;
    slowing += a < -50.0 ? 1 : 0;
    ASSERT_LE(held.hold(), along.least_cycles(0.0) + 1)
        << "at " << along.point.x[0] << " mm, " << along.point.v[0] << " mm/s, " << a << " mm/s2";
    EXPECT_LT(held.point.x[0], kLine);
  }
  EXPECT_GE(speeding, 100);
  EXPECT_GE(slowing, 50);
}

TEST(EarlyBranch, holds_before_in_and_behind_a_corner_in_little_more_than_the_way_through_it) {
  for (const auto& [x, y] : {std::pair{0.0, 30.0}, {30.0, 20.0}, {60.0, 6.0}}) {
    const PublishedCourse course(program(lines(x, y)));
    Along along(course);
    while (along.point.x[0] + along.point.x[1] < kLine - 10.0) along.step(1.0);
    for (; along.point.x[0] + along.point.x[1] < kLine + 2.0; along.step(1.0)) {
      Along held = along;
      ASSERT_LE(held.hold(), 320) << along.point.x[0] << ", corner to " << x << ' ' << y;
    }
  }
}

TEST(EarlyBranch, keeps_all_limits_in_a_hold_from_each_cycle_through_a_corner) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  for (int n = 0; n < 12; ++n) {
    const double angle = 1.0 + 0.0021 * static_cast<double>(random() % 1000),
                 length = 30.0 + 0.001 * static_cast<double>(random() % 1000);
    const PublishedCourse course(
        program({line_to(length, 0, 0, kFeed),
                 line_to(length + 30.0 * std::cos(angle), 30.0 * std::sin(angle), 0, kFeed),
                 line_to(0, 0, 0, kFeed)}));
    ASSERT_TRUE(course.whole());
    Along along(course);
    Polyline way(3, course.p.start);
    const auto step = [](Along& motion, Polyline& points, double target) {
      motion.step(target);
      points.push_back(motion.point.x);
    };
    while (along.point.x[0] < length - 1.0) step(along, way, 1.0);
    for (; along.point.x[1] < 0.3 && std::abs(along.point.x[0] - length) < 1.0; step(along, way, 1.0)) {
      if (along.speed() > 6.0) continue;
      Along held = along;
      Polyline points(way.end() - 4, way.end());
      while (!held.motion.at_rest()) step(held, points, 0.0);
      for (int k = 0; k < 3; ++k) points.push_back(points.back());
      const Reached r = reached(points, course.p.config, kCycle);
      ASSERT_LE(std::max({r.velocity, r.acceleration, r.jerk}), 1.001)
          << "seed " << seed << ", corner of " << angle << ", held at " << along.point.x[0] << ' '
          << along.point.x[1];
    }
  }
}

std::vector<Element> circle(double radius) {
  return {arc_to(2.0 * radius, 0, radius, 0, 180, kFeed), arc_to(0, 0, radius, 0, 180, kFeed)};
}

TEST(EarlyBranch, holds_on_an_arc_in_little_more_than_on_a_line) {
  struct Row {
    double radius;
    int cycles;  // of a hold at constant speed; on a line it takes 200
  };
  for (const Row& row : {Row{200.0, 205}, {60.0, 215}, {40.0, 225}}) {
    SCOPED_TRACE("radius " + std::to_string(row.radius));
    const PublishedCourse course(program(circle(row.radius)));
    ASSERT_TRUE(course.whole());
    Along along(course);
    for (int k = 0; k < 300; ++k) along.step(1.0);
    double at_constant_speed = 0.0;
    for (int k = 300; k < 300 + 8 * 40; ++k, along.step(1.0)) {
      if (k % 8 != 0) continue;
      Along held = along;
      ASSERT_LE(held.hold(), row.cycles) << "cycle " << k;
      at_constant_speed = std::max(at_constant_speed, held.point.place - along.point.place);
    }
    EXPECT_LE(at_constant_speed, 11.5);
  }
}

TEST(EarlyBranch, holds_on_an_arc_while_it_speeds_up_in_the_next_cycle) {
  const PublishedCourse course(program(circle(60)));
  ASSERT_TRUE(course.whole());
  Along along(course);
  for (int k = 0; k < 250; ++k, along.step(1.0)) {
    if (k < 20) continue;
    Along held = along;
    held.step(0.0);
    EXPECT_TRUE(held.motion.underway()) << "cycle " << k;
    EXPECT_LE(held.hold(), 320) << "cycle " << k;
    EXPECT_LE(held.point.place - along.point.place, 20.0) << "cycle " << k;
  }
}

TEST(EarlyBranch, of_an_override_is_as_fast_as_the_axes_too) {
  const PublishedCourse course(program(lines(0, 30)));
  Along along(course);
  for (int n = 0; along.point.x[0] < 150.0; ++n, along.step(1.0)) {
    if (along.speed() < 0.9 * kFeed) continue;
    for (const double ratio : {0.75, 0.3}) {
      Along slower = along;
      const int least = slower.least_cycles(ratio * kFeed);
      for (int k = 0; k < least + 2; ++k) slower.step(ratio);
      ASSERT_NEAR(slower.speed(), ratio * kFeed, 0.002 * kFeed) << ratio << " at " << along.point.x[0];
    }
  }
}

TEST(EarlyBranch, goes_on_behind_a_hold_as_fast_as_the_axes_can) {
  const PublishedCourse course(program(lines(0, 30)));
  Along along(course);
  for (int k = 0; k < 700; ++k) along.step(1.0);
  along.hold();
  const int least = along.least_cycles(kFeed);
  for (int k = 0; k < least + 2; ++k) along.step(1.0);
  EXPECT_NEAR(along.speed(), kFeed, 0.01 * kFeed);
}

TEST(EarlyBranch, is_left_for_another_wish_in_the_cycle_in_which_it_comes) {
  const PublishedCourse course(program(lines(0, 30)));
  Along along(course);
  for (int k = 0; k < 700; ++k) along.step(1.0);
  for (const double before : {0.5, 0.9, 0.0}) {
    for (int later = 1; later < 90; later += 4) {
      Along other = along;
      for (int k = 0; k < later; ++k) other.step(before);
      const double wish = before == 0.0 ? 1.0 : 0.0;
      const int least = other.least_cycles(wish * kFeed);
      for (int k = 0; k < least + 2; ++k) other.step(wish);
      ASSERT_NEAR(other.speed(), wish * kFeed, 0.002 * kFeed) << "from " << before << " after " << later;
    }
  }
}

TEST(EarlyBranch, that_is_left_while_it_still_slows_down_does_not_turn_round) {
  const PublishedCourse course(program(lines(0, 30)));
  Along along(course);
  for (int k = 0; k < 700; ++k) along.step(1.0);
  for (int k = 0; k < 120; ++k) along.step(0.0);
  for (; !along.motion.at_rest(); along.step(0.0)) {
    for (const int later : {1, 3, 9, 27}) {
      Along other = along;
      for (int k = 0; k < later; ++k) other.step(1.0);
      for (int k = 0; k < 300; ++k) {
        other.step(0.0);
        ASSERT_GE(other.motion.rate(), 0.0) << later;
      }
      EXPECT_TRUE(other.motion.at_rest());
    }
  }
}

TEST(EarlyBranch, of_a_hold_before_a_corner_is_found_again_behind_one_that_was_taken_back) {
  const PublishedCourse course(program(lines(0, 30)));
  Along along(course);
  while (along.fastest(0.0).end().s < kLine - 0.5) along.step(1.0);
  for (int n = 0; n < 40; ++n, along.step(1.0)) {
    Along once = along, again = along;
    for (int k = 0; k < 6; ++k) {
      once.step(1.0);
      again.step(0.0);
    }
    if (again.motion.underway()) continue;
    once.step(1.0);
    again.step(1.0);
    ASSERT_EQ(again.motion.rate(), 1.0);
    ASSERT_EQ(once.hold(), again.hold());
  }
}

TEST(EarlyBranch, that_is_hidden_while_it_is_driven_is_left_at_the_present_speed) {
  PublishedCourse course(program(lines(0, 30)));
  Along along(course);
  for (int k = 0; k < 150; ++k) along.step(1.0);  // it speeds up: knot follows knot
  for (int k = 0; k < 30; ++k) along.step(0.0);
  ASSERT_GT(along.speed(), 20.0);
  course.hidden_from = course.hidden_below = 0;
  double before = along.motion.rate();
  for (int k = 0; k < 40 && along.motion.underway(); ++k) {
    before = along.motion.rate();
    along.motion.step(course, 0.0, kCycle);
  }
  EXPECT_FALSE(along.motion.underway());
  EXPECT_EQ(along.motion.rate(), std::min(before, 1.0));
  course.hidden_from = 1LL << 40;
  course.hidden_below = -10;
  EXPECT_LT(along.hold(), 400);
}

// ---- whatever is asked, along lines and wide arcs of machines of all kinds

Config slow_mill() {
  Config c = mill();
  for (int i = 0; i < 3; ++i) c.limits[i] = {500.0, 200.0, 2000.0};
  return c;
}

/// X, Y and a rotary axis that is slower than the linear ones are.
Config turning_mill() {
  Config c = mill();
  c.rotary[2] = true;
  c.limits[2] = {90.0, 400.0, 6000.0};
  return c;
}

std::vector<Element> random_lines(std::mt19937_64& random) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 10001) / 10000.0;
  };
  std::vector<Element> out;
  double x = 0, y = 0, z = 0;
  for (int n = 0; n < 8; ++n) {
    const double far = n % 3 == 2 ? 8.0 : 120.0;
    x += between(-far, far), y += between(-far, far), z += n % 2 == 0 ? between(-far, far) : 0.0;
    out.push_back(line_to(x, y, z, between(20, 200)));
  }
  return out;
}

/// In short lines, all of it at the limit of acceleration of slow axes.
std::vector<Element> wide_arc(double radius) {
  std::vector<Element> out;
  const int blocks = static_cast<int>(radius * 4.0);
  for (int i = 1; i <= blocks; ++i) {
    const double angle = i * 0.3 / radius;
    out.push_back(line_to(radius - radius * std::cos(angle), radius * std::sin(angle), 0, 500));
  }
  return out;
}

struct Wishes {
  std::vector<double> targets;
  int shortest, longest;  ///< cycles
};

/// The longest waits from a wish until it is on its way.
struct Waits {
  int less = 0, any = 0;
};

/// Drives to the end, with wishes at random times for the first 5 s.
Waits judge(const PublishedCourse& course, const Wishes& wishes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Along along(course);
  Polyline points(4, course.p.start);
  double target = 1.0;
  const bool turns = *std::min_element(wishes.targets.begin(), wishes.targets.end()) < 0.0;
  Waits longest;
  int until = 100, since = 0, places = 0, cycle = 0;
  bool on = true;
  for (; on && cycle < 60000; ++cycle) {
    if (cycle == until) {
      target = cycle < 5000 ? wishes.targets[random() % wishes.targets.size()] : 1.0;
      until += wishes.shortest + static_cast<int>(random() % static_cast<unsigned>(wishes.longest));
      since = 0;
    }
    on = along.step(target) || along.motion.rate() < 0.0 || target <= 0.0;
    if (!turns && along.motion.rate() < 0.0) {
      ADD_FAILURE() << "turns round in cycle " << cycle << ", rate " << along.motion.rate();
      return longest;
    }
    const double coming = along.motion.wanted();
    since = target <= 1.0 && coming != target && along.motion.time().ns > 0 ? since + 1 : 0;
    if (target < coming) longest.less = std::max(longest.less, since);
    longest.any = std::max(longest.any, since);
    places = std::max(places, along.motion.places());
    points.push_back(along.point.x);
  }
  for (int k = 0; k < 4; ++k) points.push_back(along.point.x);
  const Reached r = reached(points, course.p.config, kCycle);
  EXPECT_FALSE(on) << "does not end";
  EXPECT_LE(std::max({r.velocity, r.acceleration, r.jerk}), 1.001)
      << "v " << r.velocity << " a " << r.acceleration << " j " << r.jerk;
  EXPECT_LE(places, RateMotion::kMostPlaces + 64);
  for (int i = 0; i < course.limits.axes; ++i)
    EXPECT_NEAR(along.point.x[i], course.p.elements.back().to[i], 1e-6);
  return longest;
}

TEST(EarlyBranch, keeps_all_limits_through_holds_overrides_and_ways_back_at_random_times) {
  const std::uint64_t base = servogate::test::property_seed();
  const Wishes any{{0.0, 0.0, 1.0, 1.0, 0.7, 0.3, 0.02, 1.5, -1.0, -0.5}, 1, 500};
  const Config configs[] = {mill(), slow_mill(), turning_mill()};
  for (std::uint64_t seed = base; seed < base + 12; ++seed) {
    std::mt19937_64 random(seed);
    const PublishedCourse course(program(random_lines(random), configs[seed % 3]));
    if (!course.whole()) continue;
    for (std::uint64_t n = 0; n < 6; ++n) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " run " + std::to_string(n));
      judge(course, any, seed + n);
    }
  }
}

TEST(EarlyBranch, leaves_the_search_its_places_on_the_arcs_of_slow_axes) {
  constexpr std::uint64_t kSeed = 77;  // what it waits is no law of all programs
  Waits longest;
  for (const double radius : {60.0, 200.0, 400.0}) {
    const PublishedCourse course(program(wide_arc(radius), slow_mill()));
    ASSERT_TRUE(course.whole());
    for (std::uint64_t n = 0; n < 6; ++n) {
      SCOPED_TRACE("seed " + std::to_string(kSeed + n) + " radius " + std::to_string(radius));
      const Waits one = judge(course, {{0.3, 1.0, 0.0}, 20, 1200 + 800 * static_cast<int>(n % 3)}, kSeed + n);
      longest = {std::max(longest.less, one.less), std::max(longest.any, one.any)};
    }
  }
  std::printf("the longest wish waited %d cycles, for less speed %d\n", longest.any, longest.less);
  EXPECT_LE(longest.less, 160);
  EXPECT_LE(longest.any, 160);
}

TEST(EarlyBranch, keeps_limits_and_tolerance_as_it_is_driven_by_a_spindle_and_with_late_planning) {
  const std::uint64_t base = servogate::test::property_seed();
  const Config configs[] = {mill(), slow_mill(), turning_mill()};
  for (std::uint64_t seed = base; seed < base + 9; ++seed) {
    std::mt19937_64 random(seed);
    RandomProgram p = program(random_lines(random), configs[seed % 3]);
    Scenario s;
    s.seed = seed;
    s.overrides = s.holds = true;
    s.starving = seed % 3 == 1;
    s.late = seed % 3 == 2;
    s.spindle = seed % 2 == 0;
    s.disturbed = 6000;
    for (Element& e : p.elements) e.revolutions = s.spindle ? Scenario::kTurns : 0.0;
    EXPECT_EQ(verdict(run(p, s), p), "") << "seed " << seed;
  }
}

}  // namespace
}  // namespace servogate::path::test
