// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/excitation/signal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "bench/drive/response/frequency_response.hpp"
#include "tests/property_seed.hpp"

namespace servogate::bench {
namespace {

constexpr double kPeriod = 0.001;

TEST(Signal, every_kind_has_a_name_that_is_read_again) {
  for (const SignalKind kind :
       {SignalKind::step, SignalKind::ramp, SignalKind::trapezoid, SignalKind::jerk_limited, SignalKind::sine,
        SignalKind::chirp, SignalKind::multisine, SignalKind::prbs}) {
    SignalKind read = SignalKind::step;
    ASSERT_TRUE(signal_named(signal_name(kind), read));
    EXPECT_EQ(read, kind);
  }
  SignalKind none;
  EXPECT_FALSE(signal_named("noise", none));
}

TEST(Signal, a_move_of_any_length_stays_within_speed_acceleration_and_jerk_and_arrives) {
  std::mt19937_64 random(test::property_seed());
  std::uniform_real_distribution<double> exponent(-2.0, 2.0);
  for (int trial = 0; trial < 200; ++trial) {
    const double distance = std::pow(10.0, exponent(random)) * (trial % 2 == 0 ? 1.0 : -1.0);
    const double speed = std::pow(10.0, exponent(random)), acceleration = std::pow(10.0, exponent(random));
    const double jerk = trial % 3 == 0 ? 0.0 : std::pow(10.0, exponent(random));
    const double time = move_time(distance, speed, acceleration, jerk);
    double before = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      const MovePoint p = move_at(distance, speed, acceleration, jerk, time * i / 1000.0);
      ASSERT_LE(std::abs(p.velocity), speed * (1.0 + 1e-6)) << distance << " " << jerk;
      ASSERT_LE(std::abs(p.acceleration), acceleration * (1.0 + 1e-6));
      if (jerk > 0.0 && i > 0) {
        ASSERT_LE(std::abs(p.acceleration - before), jerk * time / 1000.0 + 1e-6 * acceleration);
      }
      before = p.acceleration;
    }
    EXPECT_NEAR(move_at(distance, speed, acceleration, jerk, 0.999999 * time).position, distance,
                1e-3 * std::abs(distance));
    EXPECT_EQ(move_at(distance, speed, acceleration, jerk, time).position, distance);
  }
}

TEST(Signal, a_multisine_has_its_root_mean_square_and_lines_in_its_band_alone) {
  Signal s;
  s.kind = SignalKind::multisine;
  s.amplitude = 0.3;
  s.from_hz = 5.0;
  s.to_hz = 80.0;
  s.period = 1000;
  s.periods = 3;
  const auto x = samples(s, kPeriod);
  ASSERT_EQ(x.size(), 3000u);
  double squares = 0.0;
  for (const double v : x) squares += v * v;
  EXPECT_NEAR(std::sqrt(squares / 3000.0), 0.3, 1e-9);
  for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(x[i], x[i + 2000]);
  const auto h = frequency_response(x, x, x, {kPeriod, 1000});
  ASSERT_EQ(h.lines.size(), 76u);
  EXPECT_NEAR(h.valid_from_hz, 5.0, 1e-9);
  EXPECT_NEAR(h.valid_to_hz, 80.0, 1e-9);
}

TEST(Signal, a_pseudo_random_sequence_of_every_order_visits_each_state_once) {
  for (std::size_t order = 2; order <= 14; ++order) {
    Signal s;
    s.kind = SignalKind::prbs;
    s.to_hz = 400.0;  // one sample an element
    s.period = (std::size_t{1} << order) - 1;
    const auto x = samples(s, kPeriod);
    ASSERT_EQ(x.size(), s.period) << order;
    std::set<std::uint64_t> seen;
    std::uint64_t window = 0;
    for (std::size_t i = 0; i < x.size() + order - 1; ++i) {
      window = (window << 1 | (x[i % x.size()] > 0.0 ? 1u : 0u)) & s.period;
      if (i + 1 >= order) seen.insert(window);
    }
    EXPECT_EQ(seen.size(), s.period) << "order " << order << " is not of the longest period";
  }
}

TEST(Signal, a_chirp_begins_and_ends_at_its_frequencies) {
  Signal s;
  s.kind = SignalKind::chirp;
  s.from_hz = 2.0;
  s.to_hz = 50.0;
  s.duration_s = 10.0;
  const auto x = samples(s, kPeriod);
  const auto crossings = [&](std::size_t from, std::size_t to) {
    int n = 0;
    for (std::size_t i = from + 1; i < to; ++i) n += (x[i] > 0.0) != (x[i - 1] > 0.0) ? 1 : 0;
    return n;
  };
  EXPECT_NEAR(crossings(0, 1000), 4, 2);
  EXPECT_NEAR(crossings(9000, 10'000), 86, 6);  // 36 ... 50 Hz
}

TEST(Signal, a_sine_begins_at_its_phase) {
  Signal s;
  s.kind = SignalKind::sine;
  s.amplitude = 2.0;
  s.from_hz = 10.0;
  s.phase_rad = std::numbers::pi / 2.0;
  const std::vector<double> values = samples(s, 1e-3);
  ASSERT_GT(values.size(), 25u);
  EXPECT_NEAR(values[0], 2.0, 1e-12);
  EXPECT_NEAR(values[25], 0.0, 1e-9) << "a quarter of its period";
}

TEST(Signal, what_cannot_be_sampled_is_no_signal) {
  Signal s;
  s.kind = SignalKind::sine;
  s.from_hz = 500.0;
  EXPECT_TRUE(samples(s, kPeriod).empty()) << "half the sample rate";
  s.from_hz = 10.0;
  EXPECT_TRUE(samples(s, 0.0).empty());
  s.duration_s = -1.0;
  EXPECT_TRUE(samples(s, kPeriod).empty());
  s.duration_s = 1e9;
  EXPECT_TRUE(samples(s, kPeriod).empty()) << "more memory than anybody has";
  s = {};
  s.kind = SignalKind::trapezoid;
  s.acceleration = 0.0;
  EXPECT_TRUE(samples(s, kPeriod).empty());
  s = {};
  s.kind = SignalKind::multisine;
  s.from_hz = 10.2;
  s.to_hz = 10.6;
  s.period = 1000;
  EXPECT_TRUE(samples(s, kPeriod).empty()) << "no line in the band";
}

}  // namespace
}  // namespace servogate::bench
