// SPDX-License-Identifier: Apache-2.0
// Where a path is slow, and why.
#include "kernel/path/survey.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/path/rig/random_program.hpp"

namespace servogate::path::test {
namespace {

std::vector<SlowPlace> slow_places(const Config& config, std::vector<Element> elements) {
  Survey survey(config, {});
  for (std::size_t n = 0; n < elements.size(); ++n) {
    elements[n].tag.line = static_cast<std::int32_t>(n) + 1;
    EXPECT_TRUE(survey.add(elements[n]));
  }
  survey.rest();
  return survey.slowest();
}

std::vector<Element> circle(double radius, int blocks, double feed) {
  std::vector<Element> e;
  for (int i = 1; i <= blocks; ++i) {
    const double a = 2 * std::numbers::pi * i / blocks;
    e.push_back(line_to(radius - radius * std::cos(a), radius * std::sin(a), 0, feed));
  }
  return e;
}

TEST(Survey, of_a_thread_and_a_tap_ends_although_no_spindle_turns) {
  std::vector<Element> e{line_to(0, 0, -30, 15), line_to(0, 0, -60, 15), line_to(0, 0, 0, 15)};
  const Lock::Kind kinds[] = {Lock::Kind::thread, Lock::Kind::tap_in, Lock::Kind::tap_out};
  for (std::size_t n = 0; n < e.size(); ++n) {
    e[n].lock = {kinds[n], 1.5, 0.0, 0.0};
    e[n].revolutions = 10.0;
  }
  slow_places(mill(), e);
  const Estimate found = estimate(mill(), {}, e);
  EXPECT_GT(found.seconds, 120.0 / 15.0);
  EXPECT_LT(found.seconds, 120.0 / 15.0 + 2.0);
}

TEST(Survey, of_exact_stops_names_the_blocks_between_which_the_path_rests) {
  std::vector<Element> e{line_to(50, 0, 0, 100), line_to(50, 50, 0, 100), line_to(0, 50, 0, 100)};
  e[0].transition.continuation = Continuation::exact_stop;
  const auto places = slow_places(mill(), e);
  ASSERT_GE(places.size(), 3u);
  bool found = false;
  for (const SlowPlace& p : places) {
    if (p.first.line != 1 || p.last.line != 2) continue;
    found = true;
    EXPECT_EQ(p.brake, Brake::rest);
    EXPECT_EQ(p.axis, -1);
    EXPECT_NEAR(p.lost, 0.2, 0.05) << "v / a + a / j, as much as a ramp down and one up lose";
    EXPECT_LT(p.slowest, 1.0);
    EXPECT_EQ(p.feed, 100.0);
  }
  EXPECT_TRUE(found);
}

TEST(Survey, of_a_tight_circle_names_the_acceleration_of_its_axes) {
  std::vector<Element> turns;
  for (int n = 0; n < 3; ++n)
    for (const Element& e : circle(20, 600, 200)) turns.push_back(e);
  const auto places = slow_places(mill(), turns);  // 141 mm/s by the acceleration, 158 by the jerk
  ASSERT_FALSE(places.empty());
  EXPECT_EQ(places.front().brake, Brake::acceleration);
  EXPECT_GE(places.front().axis, 0);
  EXPECT_LE(places.front().axis, 1);
  EXPECT_LT(places.front().slowest, 160.0);
}

TEST(Survey, of_a_tighter_circle_and_of_a_zigzag_names_the_jerk) {
  std::vector<Element> turns;
  for (int n = 0; n < 5; ++n)
    for (const Element& element : circle(4, 200, 100)) turns.push_back(element);
  EXPECT_EQ(slow_places(mill(), turns).front().brake, Brake::jerk);  // 54 mm/s, 63 by the acceleration
  std::vector<Element> e;
  for (int i = 1; i <= 100; ++i) e.push_back(line_to(0.1 * ((i + 1) / 2), 0.1 * (i / 2), 0, 100));
  const auto places = slow_places(mill(), e);
  ASSERT_GE(places.size(), 2u);
  EXPECT_EQ(places[1].brake, Brake::jerk);
}

TEST(Survey, of_a_slow_axis_names_its_velocity) {
  Config config = mill();
  config.limits[1].velocity = 20.0;
  const auto places = slow_places(config, {line_to(0, 100, 0, 100)});
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].brake, Brake::velocity);
  EXPECT_EQ(places[0].axis, 1);
  EXPECT_EQ(places[1].brake, Brake::rest);
  EXPECT_EQ(places[1].times, 2) << "it begins and ends there";
  const auto between =
      slow_places(config, {line_to(60, 0, 0, 100), line_to(100, 80, 0, 100), line_to(180, 80, 0, 100)});
  bool found = false;
  for (const SlowPlace& p : between) found = found || (p.brake == Brake::velocity && p.axis == 1);
  EXPECT_TRUE(found);
}

TEST(Survey, compares_with_the_feed_that_a_constant_surface_speed_has_at_each_radius) {
  constexpr double kCutting = 2500.0, kPerTurn = 0.2;  // mm/s, mm
  const auto turns = [](double radius) { return kCutting / (2 * std::numbers::pi * radius); };
  const auto face = [&](double edge) {
    Config config = mill();
    config.limits[0].velocity = 8.0;
    Survey survey(config, {40});
    std::vector<Element> e{line_to(edge, 0, 0, 0), line_to(edge, -5, 0, 0)};
    const double halfway = 0.5 * (40 + edge);
    for (const double radius : {halfway, edge}) {
      Element& next = radius == edge ? e[1] : e[0];
      next.revolutions = turns(radius);
      next.feed = kPerTurn * next.revolutions;
      next.surface = {kCutting, 0.0, 1.0, turns(edge), 0};
      next.tag.line = radius == edge ? 2 : 1;
      EXPECT_TRUE(survey.add(next));
    }
    survey.rest();
    return survey.slowest();
  };
  for (const SlowPlace& p : face(12)) EXPECT_EQ(p.brake, Brake::rest) << "2 mm/s at 40 mm, 6.6 at 12 mm";
  const auto places = face(6);
  ASSERT_FALSE(places.empty());
  EXPECT_EQ(places.front().brake, Brake::velocity) << "13 mm/s at 6 mm are too much for the first axis";
  EXPECT_EQ(places.front().axis, 0);
  EXPECT_EQ(places.front().first.line, 1);
  EXPECT_GT(places.front().feed, kPerTurn * turns(10)) << "not that of halfway";
}

TEST(Survey, names_nothing_where_the_feed_is_reached_and_no_more_than_ten_places) {
  for (const SlowPlace& p : slow_places(mill(), circle(40, 800, 20))) EXPECT_EQ(p.brake, Brake::rest);
  std::vector<Element> stops;
  for (int i = 1; i <= 60; ++i) {
    stops.push_back(line_to(10.0 * i, 0, 0, 100));
    stops.back().transition.continuation = Continuation::exact_stop;
  }
  const auto places = slow_places(mill(), stops);
  ASSERT_EQ(places.size(), Survey::kMost);
  for (std::size_t n = 1; n < places.size(); ++n) EXPECT_GE(places[n - 1].lost, places[n].lost);
}

TEST(Survey, names_a_place_once_however_often_the_path_comes_there) {
  Survey survey(mill(), {});
  for (int n = 0; n < 5; ++n)
    for (int line = 1; line <= 2; ++line) {
      Element e = line_to(line == 1 ? 30.0 : 0.0, 0, 0, 100);
      e.tag.line = line;
      e.transition.continuation = Continuation::exact_stop;
      ASSERT_TRUE(survey.add(e));
    }
  survey.rest();
  const auto places = survey.slowest();
  ASSERT_GE(places.size(), 2u);
  EXPECT_EQ(places[0].times, 5) << "at one end";
  EXPECT_EQ(places[1].times, 4) << "at the other";
  EXPECT_NEAR(places[0].lost, 5 * 0.2, 0.2);
}

TEST(Survey, tells_the_time_of_the_path) {
  for (const auto& e : {circle(20, 500, 100), circle(3, 50, 100)}) {
    Survey survey(mill(), {});
    PathTime time(mill(), {});
    for (const Element& element : e) {
      ASSERT_TRUE(survey.add(element));
      ASSERT_TRUE(time.add(element));
    }
    survey.rest();
    time.rest();
    EXPECT_EQ(survey.seconds(), time.seconds());
  }
}

}  // namespace
}  // namespace servogate::path::test
