// SPDX-License-Identifier: Apache-2.0
#include "report/statistics.hpp"
#include "tests/property_seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

namespace servogate::report {
namespace {

TEST(Histogram, quantiles_are_never_below_the_truth_and_at_most_one_part_in_64_above) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(0.0, 12.0);
  for (int run = 0; run < 60; ++run) {
    Histogram h;
    std::vector<std::int64_t> values(1 + random() % 3000);
    const double top = exponent(random);
    std::uniform_real_distribution<double> magnitude(0.0, top);
    for (auto& v : values) {
      v = static_cast<std::int64_t>(std::pow(10.0, magnitude(random)));
      h.add(v);
    }
    std::sort(values.begin(), values.end());
    ASSERT_EQ(h.count(), values.size());
    ASSERT_EQ(h.max(), values.back());
    for (const double q : {0.0, 0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
      const auto rank =
          static_cast<std::size_t>(std::max(1.0, std::ceil(q * static_cast<double>(values.size()))));
      const std::int64_t truth = values[rank - 1];
      ASSERT_GE(h.quantile(q), truth) << "q " << q;
      ASSERT_LE(h.quantile(q), truth + truth / 64) << "q " << q;
    }
  }
}

TEST(Histogram, buckets_join_without_gap_and_hold_every_value) {
  Histogram h;
  for (std::int64_t v = 0; v < 5000; ++v) h.add(v);
  std::int64_t next = 0;
  std::uint64_t total = 0;
  for (const auto& b : h.buckets()) {
    ASSERT_EQ(b.from, next);
    ASSERT_EQ(b.count, static_cast<std::uint64_t>(std::min<std::int64_t>(b.to, 4999) - b.from + 1));
    next = b.to + 1;
    total += b.count;
  }
  EXPECT_EQ(total, 5000u);
  EXPECT_DOUBLE_EQ(h.mean(), 2499.5);
}

TEST(Histogram, takes_what_cannot_be_and_stays_in_its_memory) {
  Histogram h;
  EXPECT_EQ(h.quantile(0.5), 0);
  h.add(-5);
  h.add(std::int64_t{1} << 62);
  EXPECT_EQ(h.quantile(0.5), 0);
  EXPECT_EQ(h.max(), std::int64_t{1} << 40);
}

TraceAxis axis(double command, bool enabled = true, bool homed = true) {
  TraceAxis a;
  a.command = command;
  a.enabled = enabled;
  a.homed = homed;
  return a;
}

TEST(AxisStatistics, finds_the_derivatives_of_a_cubic) {
  AxisStatistics s;
  constexpr double dt = 0.001, jerk = 6000.0;
  for (int n = 0; n <= 100; ++n) {
    const double t = n * dt;
    s.add(n, dt, axis(jerk / 6.0 * t * t * t));
  }
  EXPECT_NEAR(s.max_jerk(), jerk, 1e-3);
  EXPECT_NEAR(s.max_acceleration(), jerk * (0.1 - dt), 1e-3);
  EXPECT_NEAR(s.max_velocity(), jerk / 2.0 * 0.1 * 0.1, 0.4);
}

TEST(AxisStatistics, sees_a_step_of_the_set_point_in_each_derivative) {
  AxisStatistics s;
  for (int n = 0; n < 10; ++n) s.add(n, 0.001, axis(n < 5 ? 0.0 : 0.01));
  EXPECT_NEAR(s.max_velocity(), 10.0, 1e-9);
  EXPECT_NEAR(s.max_acceleration(), 1e4, 1e-6);
  EXPECT_NEAR(s.max_jerk(), 2e7, 1e-3);
}

TEST(AxisStatistics, a_jump_while_disabled_or_by_homing_or_over_a_gap_is_no_motion) {
  AxisStatistics disabled, homing, gap;
  for (int n = 0; n < 20; ++n) {
    disabled.add(n, 0.001, axis(n < 10 ? 0.0 : 100.0, n < 8 || n >= 10));
    homing.add(n, 0.001, axis(n < 10 ? 37.0 : 0.0, true, n >= 10));
    gap.add(n < 10 ? n : n + 50, 0.001, axis(n < 10 ? 0.0 : 5.0));
  }
  EXPECT_EQ(disabled.max_velocity(), 0.0);
  EXPECT_EQ(homing.max_velocity(), 0.0);
  EXPECT_EQ(gap.max_velocity(), 0.0);
}

TEST(AxisStatistics, keeps_the_largest_following_error_of_enabled_cycles) {
  AxisStatistics s;
  TraceAxis a = axis(0.0);
  a.following_error = -0.7;
  s.add(0, 0.001, a);
  a.following_error = 0.3;
  s.add(1, 0.001, a);
  a.enabled = false;
  a.following_error = 40.0;
  s.add(2, 0.001, a);
  EXPECT_DOUBLE_EQ(s.max_following_error(), 0.7);
}

TEST(CycleTimes, keeps_each_phase_under_its_name) {
  CycleTimes times({"receive", "plc"});
  const std::int64_t phases[] = {100, 2000};
  for (int n = 0; n < 10; ++n) times.add(3000, 50 * n, phases);
  EXPECT_EQ(times.phase(0).quantile(1.0), 100);
  EXPECT_EQ(times.phase(1).max(), 2000);
  EXPECT_EQ(times.lateness().max(), 450);
  EXPECT_EQ(times.duration().count(), 10u);
}

}  // namespace
}  // namespace servogate::report
