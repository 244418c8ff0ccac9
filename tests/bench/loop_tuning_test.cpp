// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/tuning/loop_tuning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "bench/drive/measurement/loop_response.hpp"
#include "bench/drive/response/step_figures.hpp"
#include "tests/bench/plant_on_bench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// PI on one mass with a delay, as a response from 2 to `to` Hz.
FrequencyResponse loop_of(const LoopGains& g, double inertia, double delay, double to = 400.0) {
  FrequencyResponse open;
  for (double hz = 2.0; hz <= to; hz += 1.0) {
    const Complex s(0.0, kTurn * hz);
    open.lines.push_back(
        {hz, g.velocity_gain * (1.0 + g.velocity_integral / s) / (inertia * s) * std::exp(-s * delay), 1.0});
  }
  open.valid_from_hz = 2.0;
  open.valid_to_hz = to;
  return open;
}

TEST(LoopTuning, of_random_masses_and_delays_keeps_its_margins_and_is_as_stiff_as_they_allow) {
  std::mt19937_64 random(test::property_seed());
  const auto between = [&random](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  for (int trial = 0; trial < 50; ++trial) {
    const double inertia = between(1e-5, 1e-1), delay = between(5e-4, 3e-3);
    const LoopGains present{inertia * between(50.0, 400.0), between(1.0, 60.0), 20.0};
    const auto found = tune(loop_of(present, inertia, delay), present, {});
    ASSERT_TRUE(found) << trial;
    // The truth, not what it expects of itself.
    const FrequencyResponse real = loop_of(found->gains, inertia, delay);
    const Margins m = margins(real);
    ASSERT_TRUE(m.phase_margin_deg);
    EXPECT_GE(*m.phase_margin_deg, 49.9);
    const double ratio = found->gains.velocity_gain / present.velocity_gain;
    LoopGains stiffer = found->gains;
    stiffer.velocity_gain *= 1.6;
    const Margins beyond = margins(loop_of(stiffer, inertia, delay));
    const bool at_the_limit =
        beyond.phase_margin_deg.value_or(0.0) < 50.0 || beyond.gain_margin_db.value_or(0.0) < 8.0;
    EXPECT_TRUE(ratio > 9.5 || at_the_limit) << trial;
    EXPECT_GT(found->gains.position_gain, 1.0);
    EXPECT_LT(found->gains.position_gain, kTurn * *m.crossover_hz) << "slower than the loop inside of it";
  }
}

TEST(LoopTuning, finds_a_position_gain_on_a_response_that_begins_late) {
  const LoopGains present{0.4, 60.0, 20.0};
  FrequencyResponse open = loop_of(present, 1e-3, 1e-3);
  const auto whole = tune(open, present, {});
  open.valid_from_hz = 50.0;
  const auto part = tune(open, present, {});
  ASSERT_TRUE(whole && part);
  EXPECT_NEAR(part->gains.position_gain, whole->gains.position_gain, 0.2 * whole->gains.position_gain);
  EXPECT_TRUE(part->position.phase_margin_deg);
}

TEST(LoopTuning, names_no_position_gain_where_none_keeps_the_wish) {
  const LoopGains present{0.4, 60.0, 20.0};
  TuningWish wish;
  wish.position_peak_db = -1.0;  // no loop with an integrator does
  const auto found = tune(loop_of(present, 1e-3, 1e-3), present, wish);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->gains.position_gain, 0.0);
  EXPECT_FALSE(found->position.crossover_hz);
}

TEST(LoopTuning, promises_nothing_beyond_what_was_measured) {
  const LoopGains present{0.1, 10.0, 20.0};
  // A loop without any delay up to 100 Hz: a crossover near or beyond that cannot be known to be stable.
  const auto found = tune(loop_of(present, 1e-3, 1e-5, 100.0), present, {});
  ASSERT_TRUE(found);
  EXPECT_LT(*found->velocity.crossover_hz, 50.0);
}

TEST(LoopTuning, expects_the_step_of_the_textbook) {
  // Closed loop of first order: 1 - exp(-w t).
  FrequencyResponse closed;
  const double w = 60.0;
  for (double hz = 1.0; hz <= 450.0; hz += 1.0)
    closed.lines.push_back({hz, 1.0 / (1.0 + Complex(0.0, kTurn * hz / w)), 1.0});
  closed.valid_from_hz = 1.0;
  closed.valid_to_hz = 450.0;
  const auto y = step_of(closed, 1e-3, 0.1);
  ASSERT_EQ(y.size(), 100u);
  for (std::size_t i = 5; i < y.size(); ++i)
    EXPECT_NEAR(y[i], 1.0 - std::exp(-w * 1e-3 * static_cast<double>(i)), 0.015) << i;
}

TEST(LoopTuning, sees_a_resonance_behind_the_crossover_and_a_notch_lets_it_be_stiffer) {
  const LoopGains present{0.05, 5.0, 10.0};
  FrequencyResponse open = loop_of(present, 1e-3, 8e-4);
  for (ResponseLine& line : open.lines) {
    const Complex s(0.0, line.hz);
    const double peak = 150.0;
    line.value *= peak * peak / (s * s + 0.06 * peak * s + peak * peak);
  }
  const auto notch = notch_for(open);
  ASSERT_TRUE(notch);
  EXPECT_NEAR(notch->hz, 150.0, 2.0);
  const auto without = tune(open, present, {}), with = tune(open, present, {}, &*notch);
  ASSERT_TRUE(without && with);
  EXPECT_GT(with->gains.velocity_gain, 1.3 * without->gains.velocity_gain);
  EXPECT_FALSE(notch_for(loop_of(present, 1e-3, 8e-4)));
}

TEST(LoopTuning, of_a_measured_drive_comes_true_on_that_drive) {
  mock::PlantConfig p;
  p.counts_per_rev = 1 << 20;
  p.velocity_gain = 0.12;
  p.velocity_integral = 10.0;
  p.coulomb_friction_nm = 0.02;
  const LoopGains present{p.velocity_gain, p.velocity_integral, p.position_gain};
  LoopResponsePlan plan;
  plan.offset = 12.0;
  plan.to_hz = 350.0;
  std::optional<Tuning> found;
  {
    PlantOnBench drive(p);
    Guard guard(drive, {-1000.0, 1000.0, 200.0, 7.0, 60.0, 10.0});
    ASSERT_TRUE(guard.enable(Loop::velocity));
    const auto before = take_loop_response(guard, plan);
    ASSERT_TRUE(before);
    for (const ResponseLine& line : before->plant.lines) {
      if (line.hz < 10.0 || line.hz > 150.0) continue;
      EXPECT_NEAR(std::abs(line.value) * kTurn * line.hz * p.inertia_kg_m2, 1.0, 0.05) << line.hz;
    }
    found = tune(velocity_loop(before->plant, present, 5e-4), present, {});
  }
  ASSERT_TRUE(found);
  EXPECT_GT(found->gains.velocity_gain, 2.0 * present.velocity_gain);
  p.velocity_gain = found->gains.velocity_gain;
  p.velocity_integral = found->gains.velocity_integral;
  PlantOnBench drive(p);
  Guard guard(drive, {-1000.0, 1000.0, 200.0, 7.0, 60.0, 10.0});
  ASSERT_TRUE(guard.enable(Loop::velocity));
  ASSERT_TRUE(guard.run_at(10.0, 100.0, 0.2));
  std::vector<double> step;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(guard.step(Loop::velocity, 12.0));
    step.push_back((guard.speed_rad_s() - 10.0) / 2.0);
  }
  step.erase(step.begin(), step.begin() + 2);
  const auto measured = step_figures(step, 1e-3, 0.0, 1.0, 0.05);
  const auto expected = step_figures(step_of(found->closed, 1e-3, 0.2), 1e-3, 0.0, 1.0, 0.05);
  ASSERT_TRUE(measured && expected && measured->rise_s && expected->rise_s);
  EXPECT_NEAR(*measured->rise_s, *expected->rise_s, 0.001);
  EXPECT_NEAR(measured->overshoot, expected->overshoot, 0.12);
}

}  // namespace
}  // namespace servogate::bench
