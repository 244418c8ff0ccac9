// SPDX-License-Identifier: Apache-2.0
// The time of courses told beforehand, beside that in which they are driven.
#include "kernel/path/law/forecast.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "kernel/path/path_time.hpp"
#include "tests/path/rig/random_program.hpp"
#include "tests/property_seed.hpp"

namespace servogate::path::test {
namespace {

using Elements = std::vector<Element>;

Elements circle(double radius, int blocks, double feed) {
  Elements e;
  for (int k = 1; k <= blocks; ++k) {
    const double a = 2 * std::numbers::pi * k / blocks;
    e.push_back(line_to(radius * std::cos(a) - radius, radius * std::sin(a), 0, feed));
  }
  return e;
}

Elements zigzag(int blocks, double length, double feed) {
  Elements e;
  for (int k = 1; k <= blocks; ++k) e.push_back(line_to(length * ((k + 1) / 2), length * (k / 2), 0, feed));
  return e;
}

/// Each block turns by up to `turn` radians.
Elements walk(int blocks, double length, double turn, double feed) {
  std::mt19937 random(5);
  Elements e;
  double heading = 0, x = 0, y = 0;
  for (int k = 0; k < blocks; ++k) {
    heading += turn * (2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0);
    x += length * std::cos(heading);
    y += length * std::sin(heading);
    e.push_back(line_to(x, y, 0, feed));
  }
  return e;
}

/// Straight for six blocks, then back across.
Elements saw(int blocks, double feed) {
  Elements e;
  for (int k = 1; k <= blocks; ++k) e.push_back(line_to(k, k % 7, 0, feed));
  return e;
}

double told(const Config& config, const Elements& elements) {
  PathTime time(config, {});
  for (const Element& e : elements) EXPECT_TRUE(time.add(e));
  time.rest();
  return time.seconds();
}

void expect_share(double share, const Elements& elements, const Config& config, const std::string& what) {
  const double driven = estimate(config, {}, elements).seconds;
  EXPECT_NEAR(told(config, elements) / driven, 1.0, share) << what << " is driven in " << driven << " s";
}

constexpr double kSlow = 1000.0 / 60.0;  // mm/s, a usual feed

TEST(Forecast, of_a_feed_that_is_reached_is_right_to_a_fiftieth) {
  expect_share(0.02, circle(20, 500, kSlow), mill(), "a circle");
  expect_share(0.02, zigzag(20, 40, kSlow), mill(), "long lines");
  expect_share(0.02, walk(400, 0.3, 0.1, kSlow), mill(), "a smooth path of short blocks");
  expect_share(0.03, walk(200, 1, 0.3, kSlow), mill(), "a rougher one");
  expect_share(0.02, saw(100, kSlow), mill(), "corners");
}

TEST(Forecast, where_limits_bind_is_right_to_a_tenth) {
  expect_share(0.1, circle(20, 500, 200), mill(), "a circle at its acceleration");
  expect_share(0.1, walk(500, 0.1, 0.3, 100), mill(), "blocks of 0.1 mm");
  expect_share(0.1, walk(300, 0.3, 1, 100), mill(), "blocks of 0.3 mm that turn far");
  expect_share(0.1, walk(200, 1, 0.3, 100), mill(), "blocks of 1 mm");
  expect_share(0.1, walk(200, 3, 1, 100), mill(), "blocks of 3 mm");
  expect_share(0.12, saw(200, 100), mill(), "corners");
  expect_share(0.06, zigzag(60, 10, 100), mill(), "a zigzag");
}

TEST(Forecast, of_zigzags_within_the_time_of_a_corner_is_right_to_a_sixth) {
  expect_share(0.17, zigzag(200, 0.1, 100), mill(), "0.1 mm");
  expect_share(0.17, zigzag(100, 1, 100), mill(), "1 mm");
}

TEST(Forecast, of_steps_that_the_tolerance_hides_and_of_slow_feeds_is_right_to_a_tenth) {
  Elements steps{line_to(10, 0, 0, 100)};
  for (int k = 1; k <= 4000; ++k) steps.push_back(line_to(10 + 0.001 * k, 0.0004 * (k % 2), 0, 100));
  expect_share(0.1, steps, mill(), "micrometres from side to side");
  expect_share(0.03, circle(20, 500, 100), mill(), "a circle from rest to rest in a second");
  constexpr double kVerySlow = 0.1 / 60.0;
  expect_share(0.02, {line_to(0.02, 0, 0, kVerySlow), line_to(0.02, 0.02, 0, kVerySlow)}, mill(),
               "0.1 mm/min");
}

TEST(Forecast, of_random_programs_together_is_right_to_a_twentieth) {
  const std::uint64_t first = servogate::test::property_seed();
  double driven = 0.0, foretold = 0.0;
  for (std::uint64_t n = 0; n < 40; ++n) {
    const RandomProgram p = random_program(first + n, {n % 3 == 0 ? 80 : 12, true, false});
    PathTime time(p.config, p.start);
    for (const Element& e : p.elements) ASSERT_TRUE(time.add(e));
    time.rest();
    foretold += time.seconds();
    driven += estimate(p.config, p.start, p.elements).seconds;
  }
  EXPECT_NEAR(foretold / driven, 1.0, 0.07);
}

/// Runs as they are gathered, and all of them at once.
struct Runs final : RunSink {
  std::vector<Leg> legs;
  void put(const Leg& leg) override { legs.push_back(leg); }
  void cruise(const Leg& leg, double /*speed*/) override { legs.push_back(leg); }
  void rest(bool /*confirm*/) override {}
};

struct Moments final : MomentSink {
  double seconds = 0.0;
  std::vector<double> feeds;
  void put(const Moment& moment) override {
    seconds += moment.seconds;
    feeds.push_back(moment.feed);
  }
};

TEST(Forecast, does_not_depend_on_when_elements_come) {
  const Config config = mill();
  Runs gathered;
  Gather gather(config, gathered);
  for (const Element& e : walk(3000, 0.3, 0.3, 100)) ASSERT_TRUE(gather.add(e));
  std::vector<std::vector<double>> feeds;
  for (const std::size_t portion : {1, 7, 10'000}) {
    Moments moments;
    SpeedForecast speed(config.axis_count, *config.transformation, moments);
    path::Run run(config.axis_count);
    speed.clear(0.0);
    for (std::size_t n = 0; n < gathered.legs.size(); ++n) {
      run.append(gathered.legs[n]);
      if (n % portion == 0) speed.work(run, false);
    }
    speed.work(run, true);
    EXPECT_EQ(speed.seconds(), moments.seconds);
    feeds.push_back(moments.feeds);
  }
  EXPECT_EQ(feeds[0], feeds[1]);
  EXPECT_EQ(feeds[0], feeds[2]);
}

}  // namespace
}  // namespace servogate::path::test
