// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/s_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace servogate::path {
namespace {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  double logarithmic(double a, double b) { return a * std::pow(b / a, uniform(0, 1)); }
  bool chance(double p) { return uniform(0, 1) < p; }
  Box box() { return {logarithmic(0.1, 1000), logarithmic(1, 2e4), logarithmic(100, 1e6)}; }
  /// A state from which speed can still be brought inside the box.
  MotionState state(const Box& b) {
    MotionState s{uniform(0, 10), uniform(0, 1) * b.velocity, 0.0};
    if (chance(0.6)) {
      const double up = std::min(b.acceleration, std::sqrt(2.0 * b.jerk * (b.velocity - s.v)));
      const double down = std::min(b.acceleration, std::sqrt(2.0 * b.jerk * s.v));
      s.a = uniform(-down, up);
    }
    return s;
  }

 private:
  std::mt19937_64 random_;
};

/// Empty when the profile keeps the box all along.
std::string broken(const Profile& p, const Box& b) {
  const double slack = 1e-7;
  double before = p.at(0.0).s;
  for (int k = 0; k <= 24; ++k) {
    const MotionState m = p.at(p.duration() * k / 24.0);
    if (m.v < -slack * b.velocity || m.v > b.velocity * (1 + slack))
      return "velocity " + std::to_string(m.v / b.velocity);
    if (std::abs(m.a) > b.acceleration * (1 + slack))
      return "acceleration " + std::to_string(m.a / b.acceleration);
    if (m.s < before - 1e-9) return "moves backwards";
    before = m.s;
  }
  return {};
}

TEST(SCurve, keeps_its_box_and_rests_at_the_end_of_its_way_from_a_million_states) {
  constexpr std::uint64_t kSeed = 20240611;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Dice dice(kSeed);
  int planned = 0, rested = 0;
  for (int k = 0; k < 1'000'000; ++k) {
    const Box b = dice.box();
    const MotionState from = dice.state(b);
    Goal g;
    g.velocity = dice.chance(0.15) ? 0.0 : dice.uniform(0.01, 1.0) * b.velocity;
    g.length = ramp_distance(from.v, from.a, 0.0, b) * dice.logarithmic(0.9, 100) + 1e-9;
    Profile p;
    p.start({-1, -1, -1});
    if (!plan(p, from, g, b)) {
      ASSERT_EQ(p.end().s, -1.0) << "a refusal leaves the profile alone";
      continue;
    }
    ++planned;
    const MotionState end = p.end();
    ASSERT_EQ(broken(p, b), "") << k;
    ASSERT_EQ(end.a, 0.0);
    ASSERT_EQ(end.v, 0.0) << k;
    // The phases really lead where the profile says that it ends.
    Profile again;
    again.start(from);
    const MotionState last = p.at(p.duration() * (1 - 1e-12));
    ASSERT_NEAR(last.s, end.s, 1e-8 * (1 + g.length)) << k;
    ASSERT_NEAR(last.v, end.v, 1e-5 * b.velocity) << k;
    if (end.s < from.s + g.length) {
      ASSERT_EQ(g.velocity, 0.0) << "only a wish to rest ends before the end";
      ++rested;
    }
  }
  // Each of the ways out was met often.
  EXPECT_GT(planned, 700'000);
  EXPECT_GT(rested, 10'000);
}

TEST(SCurve, drives_what_is_left_by_rounding_in_no_time) {
  Dice dice(20261122);
  for (int k = 0; k < 1'000'000; ++k) {
    const Box b = dice.box();
    MotionState from{dice.uniform(0, 10), dice.chance(0.2) ? 0.0 : dice.logarithmic(1e-22, 1e-6), 0.0};
    if (dice.chance(0.3)) from.a = -dice.uniform(0, 1) * std::sqrt(2.0 * b.jerk * from.v);
    Goal g;
    g.velocity = b.velocity * dice.logarithmic(0.01, 1);
    g.length = dice.logarithmic(1e-18, 1e-7);
    Profile p;
    if (!plan(p, from, g, b)) continue;
    ASSERT_LT(p.duration(), 1.0) << k << ": " << g.length << " mm from " << from.v << " mm/s";
  }
}

TEST(SCurve, finds_a_way_wherever_rest_can_be_reached) {
  Dice dice(7);
  for (int k = 0; k < 300'000; ++k) {
    const Box b = dice.box();
    const MotionState from = dice.state(b);
    Goal g;
    g.velocity = dice.uniform(0.2, 1.0) * b.velocity;
    g.length = ramp_distance(from.v, from.a, 0.0, b) * dice.logarithmic(1.0001, 3.0);
    Profile p;
    if (g.length < 1e-6) continue;
    ASSERT_TRUE(plan(p, from, g, b)) << k;
    ASSERT_EQ(p.end().v, 0.0) << k;
    ASSERT_NEAR(p.end().s, from.s + g.length, 1e-9) << k;
  }
}

TEST(SCurve, from_rest_to_rest_takes_the_textbook_time) {
  Dice dice(3);
  for (int k = 0; k < 100'000; ++k) {
    const Box b = dice.box();
    const double length = dice.logarithmic(1e-6, 1e4);
    // Reached speed by the closed forms of the seven-phase profile.
    const double v = b.velocity, a = b.acceleration, j = b.jerk;
    const auto ramp = [&](double w) { return w * j <= a * a ? 2 * std::sqrt(w / j) : w / a + a / j; };
    double expected;
    if (v * ramp(v) <= length) {
      expected = 2 * ramp(v) + (length - v * ramp(v)) / v;
    } else if (2 * a * a * a / (j * j) >= length) {
      expected = 4 * std::cbrt(length / (2 * j));
    } else {
      const double w = 0.5 * (-a * a / j + std::sqrt(a * a * a * a / (j * j) + 4 * a * length));
      expected = 2 * ramp(w);
    }
    Profile p;
    ASSERT_TRUE(plan(p, {}, {length, v}, b));
    ASSERT_NEAR(p.duration(), expected, 1e-6 * expected)
        << k << " " << v << " " << a << " " << j << " " << length;
  }
}

TEST(SCurve, brakes_to_rest_at_once_when_asked) {
  const Box b{500, 1000, 10000};
  Profile p;
  ASSERT_TRUE(plan(p, {0, 100, 0}, {1000, 0}, b));
  EXPECT_NEAR(p.duration(), 0.2, 1e-12);  // 100 / 1000 + 1000 / 10000
  EXPECT_NEAR(p.end().s, 10.0, 1e-9);
  EXPECT_LT(p.at(0.001).a, 0.0) << "the first thing it does is to brake";
}

TEST(SCurve, reachable_speed_is_the_inverse_of_the_ramp_distance) {
  Dice dice(11);
  for (int k = 0; k < 300'000; ++k) {
    const Box b = dice.box();
    const double length = dice.logarithmic(1e-7, 1e3);
    const double v = reachable_speed(length, b);
    ASSERT_NEAR(ramp_distance(v, 0.0, 0.0, b), length, 1e-9 * length) << k;
    ASSERT_NEAR(ramp_distance(0.0, 0.0, v, b), length, 1e-9 * length) << k;
  }
}

TEST(SCurve, a_longer_way_never_takes_less_time) {
  Dice dice(5);
  for (int k = 0; k < 100'000; ++k) {
    const Box b = dice.box();
    const double length = dice.logarithmic(1e-5, 100);
    Profile p, q;
    ASSERT_TRUE(plan(p, {}, {length, b.velocity}, b));
    ASSERT_TRUE(plan(q, {}, {length * 1.01, b.velocity}, b));
    ASSERT_GE(q.duration(), p.duration() * (1 - 1e-9)) << k;
  }
}

}  // namespace
}  // namespace servogate::path
