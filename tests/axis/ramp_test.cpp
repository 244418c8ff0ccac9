// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/setpoint/ramp.hpp"
#include "tests/property_seed.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

namespace servogate::axis {
namespace {

constexpr MotionLimits kMill{500.0, 1000.0, 10000.0};

/// Judges a motion by the finite differences of its positions alone.
class Judge {
 public:
  Judge(double x, double dt) : dt_(dt), x_{x, x, x, x} {}
  void add(double x) {
    x_[0] = x_[1], x_[1] = x_[2], x_[2] = x_[3], x_[3] = x;
    const double v = (x_[3] - x_[2]) / dt_, a = (x_[3] - 2 * x_[2] + x_[1]) / (dt_ * dt_);
    const double j = (x_[3] - 3 * x_[2] + 3 * x_[1] - x_[0]) / (dt_ * dt_ * dt_);
    velocity = std::max(velocity, std::abs(v));
    acceleration = std::max(acceleration, std::abs(a));
    jerk = std::max(jerk, std::abs(j));
  }
  ::testing::AssertionResult within(const MotionLimits& m) const {
    constexpr double kSlack = 1.001;
    if (velocity <= m.velocity * kSlack && acceleration <= m.acceleration * kSlack && jerk <= m.jerk * kSlack)
      return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "v " << velocity << " of " << m.velocity << ", a " << acceleration
                                         << " of " << m.acceleration << ", j " << jerk << " of " << m.jerk;
  }
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;

 private:
  double dt_;
  double x_[4];
};

unsigned fresh_seed() {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  return seed;
}

/// Time of the time-optimal move between two points of rest.
double optimal_time(double d, const MotionLimits& m) {
  const double v3 = m.acceleration * m.acceleration / m.jerk;
  auto ramp_time = [&](double v) {
    return v >= v3 ? v / m.acceleration + m.acceleration / m.jerk : 2 * std::sqrt(v / m.jerk);
  };
  if (m.velocity * ramp_time(m.velocity) <= d)
    return ramp_time(m.velocity) * 2 + (d - m.velocity * ramp_time(m.velocity)) / m.velocity;
  double lo = 0, hi = m.velocity;
  for (int i = 0; i < 100; ++i) {
    const double mid = (lo + hi) / 2;
    (mid * ramp_time(mid) < d ? lo : hi) = mid;
  }
  return 2 * ramp_time(lo);
}

TEST(Ramp, from_rest_to_rest_is_time_optimal_and_ends_exactly) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-6.0, 3.0);
  for (int i = 0; i < 200'000; ++i) {
    const double d = std::pow(10.0, exponent(random)) * (i % 2 ? 1 : -1);
    Ramp ramp;
    ramp.reset({1.0, 0.0, 0.0}, kMill);
    ramp.move_to(1.0 + d, kMill);
    ASSERT_NEAR(ramp.time_left(), optimal_time(std::abs(d), kMill), 1e-7 + 1e-9 / std::abs(d)) << d;
    ramp.step(ramp.time_left() + 1e-9);
    ASSERT_TRUE(ramp.done());
    ASSERT_EQ(ramp.state().x, 1.0 + d);
  }
}

TEST(Ramp, stays_within_the_limits_with_a_new_target_in_any_cycle) {
  std::mt19937_64 random(fresh_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  constexpr double kDt = 0.001;
  long cases = 0;
  for (int run = 0; run < 4000; ++run) {
    const MotionLimits m{std::pow(10.0, 3 * unit(random)), std::pow(10.0, 1 + 3 * unit(random)),
                         std::pow(10.0, 2 + 4 * unit(random))};
    Ramp ramp;
    ramp.reset({100 * unit(random), 0.0, 0.0}, m);
    Judge judge(ramp.state().x, kDt);
    for (int order = 0; order < 300; ++order, ++cases) {
      const double kind = unit(random);
      if (kind < 0.6)
        ramp.move_to(ramp.state().x + (unit(random) - 0.5) * std::pow(10.0, 5 * unit(random) - 2), m);
      else if (kind < 0.8)
        ramp.move_at((unit(random) - 0.5) * 2 * m.velocity, m);
      else
        ramp.stop(m);
      for (int k = static_cast<int>(unit(random) * 20); k >= 0; --k) judge.add(ramp.step(kDt).x);
      ASSERT_TRUE(judge.within(m)) << "run " << run << " order " << order;
    }
    const double target = ramp.state().x + (unit(random) - 0.5) * 20;
    ramp.move_to(target, m);
    const double time = ramp.time_left();
    for (double t = 0; t < time; t += kDt) judge.add(ramp.step(kDt).x);
    for (int k = 0; k < 4; ++k) judge.add(ramp.step(kDt).x);
    ASSERT_TRUE(judge.within(m)) << "run " << run << " at the end";
    ASSERT_TRUE(ramp.done());
    ASSERT_EQ(ramp.state().x, target);
  }
  EXPECT_GE(cases, 1'000'000);
}

TEST(Ramp, plans_a_million_random_states_to_an_end_that_is_exact_and_near_optimal) {
  std::mt19937_64 random(fresh_seed());
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst_ratio = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    MotionState s{unit(random) * 300, unit(random) * 500, unit(random) * 1000};
    // a state that the limits permit: taking the acceleration away does not leave the velocity limit
    if (std::abs(s.v + s.a * std::abs(s.a) / 20000.0) > 500.0) continue;
    Ramp ramp;
    ramp.reset(s, kMill);
    const double target = unit(random) * 300;
    ramp.move_to(target, kMill);
    const double t = ramp.time_left();
    // never longer than stopping first and starting anew
    Ramp stop_first;
    stop_first.reset(s, kMill);
    const double stopped = s.x + Ramp::stopping_distance(s, kMill);
    const double anew = stop_first.time_left() + optimal_time(std::abs(target - stopped), kMill);
    worst_ratio = std::max(worst_ratio, t / anew);
    const MotionState before = ramp.step(t - 1e-7);
    ASSERT_NEAR(before.x, target, 1e-8) << i;
    ASSERT_NEAR(before.v, 0.0, 1e-6) << i;
    ramp.step(2e-7);
    ASSERT_TRUE(ramp.done());
    ASSERT_EQ(ramp.state().x, target);
  }
  std::printf("longest against stop-and-start-anew: %.4f\n", worst_ratio);
  EXPECT_LE(worst_ratio, 1.0 + 1e-6);
}

TEST(Ramp, never_overshoots_a_target_that_lies_beyond_the_stop) {
  std::mt19937_64 random(fresh_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 20'000; ++i) {
    const MotionState s{0.0, unit(random) * 450, -unit(random) * 900};
    const double stop = Ramp::stopping_distance(s, kMill);
    if (s.v < s.a * s.a / (2 * kMill.jerk)) continue;  // even the stop itself runs back there
    const double target = stop + unit(random) * (i % 2 ? 100.0 : 1e-3);
    Ramp ramp;
    ramp.reset(s, kMill);
    ramp.move_to(target, kMill);
    while (!ramp.done()) ASSERT_LE(ramp.step(0.001).x, target + 1e-9) << i;
  }
}

TEST(Ramp, brings_a_state_outside_new_tighter_limits_back_inside) {
  Ramp ramp;
  ramp.reset({0.0, 0.0, 0.0}, kMill);
  ramp.move_at(500.0, kMill);
  for (int i = 0; i < 300; ++i) ramp.step(0.001);
  const MotionLimits slow{5.0, 200.0, 5000.0};
  ramp.move_to(1000.0, slow);
  double last = ramp.state().v;
  while (ramp.state().v > 5.0 + 1e-9) {
    ramp.step(0.001);
    last = ramp.state().v;
    ASSERT_FALSE(ramp.done());
  }
  EXPECT_LE(last, 5.0 + 1e-9);
  while (!ramp.done()) ASSERT_LE(std::abs(ramp.step(0.01).v), 5.0 + 1e-9);
  EXPECT_EQ(ramp.state().x, 1000.0);
}

TEST(Ramp, repeating_the_same_order_changes_nothing) {
  Ramp once, often;
  for (Ramp* r : {&once, &often}) {
    r->reset({0.0, 0.0, 0.0}, kMill);
    r->move_to(77.7, kMill);
  }
  for (int i = 0; i < 2000; ++i) {
    often.move_to(77.7, kMill);
    ASSERT_EQ(once.step(0.001).x, often.step(0.001).x);
  }
}

TEST(Ramp, a_shift_of_the_coordinates_moves_state_and_target_alike) {
  Ramp ramp;
  ramp.reset({10.0, 0.0, 0.0}, kMill);
  ramp.move_to(20.0, kMill);
  for (int i = 0; i < 50; ++i) ramp.step(0.001);
  const double left = ramp.target() - ramp.state().x;
  ramp.shift(-110.0);
  EXPECT_NEAR(ramp.target() - ramp.state().x, left, 1e-12);
  while (!ramp.done()) ramp.step(0.001);
  EXPECT_EQ(ramp.state().x, -90.0);
}

TEST(Ramp, a_lasting_velocity_stays_and_its_stop_takes_the_shortest_way) {
  Ramp ramp;
  ramp.reset({0.0, 0.0, 0.0}, kMill);
  ramp.move_at(100.0, kMill);
  for (int i = 0; i < 1000; ++i) ramp.step(0.001);
  EXPECT_EQ(ramp.state().v, 100.0);
  const double from = ramp.state().x, way = Ramp::stopping_distance(ramp.state(), kMill);
  EXPECT_NEAR(way, 100.0 * (100.0 / 1000.0 + 1000.0 / 10000.0) / 2, 1e-9);
  ramp.stop(kMill);
  while (!ramp.done()) ramp.step(0.001);
  EXPECT_NEAR(ramp.state().x, from + way, 1e-9);
}

}  // namespace
}  // namespace servogate::axis
