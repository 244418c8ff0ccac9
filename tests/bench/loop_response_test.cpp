// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/loop_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/bench/plant_on_bench.hpp"

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr Envelope kWide{-1000.0, 1000.0, 200.0, 7.0, 60.0, 10.0};

/// The velocity loop of the simulated drive as the textbook has it: PI, lag of the current, one rigid mass,
/// sampled every 0.25 ms with the output held.
Complex velocity_loop(const mock::PlantConfig& p, double hz) {
  const Complex s(0.0, kTurn * hz);
  const double gain = p.velocity_gain > 0.0 ? p.velocity_gain : 600.0 * p.inertia_kg_m2;
  return gain * (1.0 + p.velocity_integral / s) / (p.inertia_kg_m2 * s) /
         (1.0 + s * p.current_time_constant_s) * std::exp(-s * 1.5 * 0.25e-3);
}

LoopResponsePlan velocity_plan() {
  LoopResponsePlan plan;
  plan.excitation = 1.0;
  plan.offset = 12.0;
  plan.from_hz = 3.0;
  plan.to_hz = 350.0;
  return plan;
}

TEST(LoopResponse, of_the_velocity_loop_is_that_of_the_textbook) {
  mock::PlantConfig p;
  p.counts_per_rev = 1 << 20;
  PlantOnBench drive(p);
  Guard guard(drive, kWide);
  ASSERT_TRUE(guard.enable(Loop::velocity));
  const auto found = take_loop_response(guard, velocity_plan());
  ASSERT_TRUE(found);
  EXPECT_LT(found->closed.valid_from_hz, 5.0);
  EXPECT_GT(found->closed.valid_to_hz, 200.0);
  // Where |L| = 1 by the formula.
  double crossover = 1.0;
  while (std::abs(velocity_loop(p, crossover)) > 1.0) crossover *= 1.001;
  ASSERT_TRUE(found->margins.crossover_hz && found->margins.phase_margin_deg && found->bandwidth_hz);
  // The simulation's own steps lead by a quarter of a millisecond.
  EXPECT_NEAR(*found->margins.crossover_hz, crossover, 0.2 * crossover);
  const double margin = 180.0 + std::arg(velocity_loop(p, crossover)) * 360.0 / kTurn;
  EXPECT_NEAR(*found->margins.phase_margin_deg, margin, 25.0);
  EXPECT_GT(*found->bandwidth_hz, crossover);
}

TEST(LoopResponse, shows_twice_the_crossover_with_twice_the_gain) {
  const auto crossover = [](double gain) {
    mock::PlantConfig p;
    p.counts_per_rev = 1 << 20;
    p.velocity_gain = gain;
    p.velocity_integral = 10.0;
    PlantOnBench drive(p);
    Guard guard(drive, kWide);
    EXPECT_TRUE(guard.enable(Loop::velocity));
    const auto found = take_loop_response(guard, velocity_plan());
    return found && found->margins.crossover_hz ? *found->margins.crossover_hz : 0.0;
  };
  const double low = crossover(0.2), high = crossover(0.4);
  EXPECT_NEAR(low, 0.2 / 1e-3 / kTurn, 2.0);
  EXPECT_NEAR(high / low, 2.0, 0.1);
}

TEST(LoopResponse, of_the_position_loop_has_the_bandwidth_of_its_gain) {
  mock::PlantConfig p;
  p.counts_per_rev = 1 << 20;
  p.coulomb_friction_nm = 0.01;
  p.position_gain = 60.0;
  PlantOnBench drive(p);
  Guard guard(drive, kWide);
  ASSERT_TRUE(guard.enable(Loop::position));
  LoopResponsePlan plan;
  plan.loop = Loop::position;
  plan.excitation = 0.02;
  plan.from_hz = 1.0;
  plan.to_hz = 60.0;
  const auto found = take_loop_response(guard, plan);
  ASSERT_TRUE(found);
  EXPECT_GT(found->closed.valid_to_hz, 20.0);
  ASSERT_TRUE(found->bandwidth_hz);
  EXPECT_GT(*found->bandwidth_hz, 60.0 / kTurn);
}

TEST(LoopResponse, of_an_excitation_that_cannot_be_sampled_is_none_and_moves_nothing) {
  LoopResponsePlan plan;
  plan.from_hz = 600.0;
  EXPECT_TRUE(loop_excitation(plan, 1e-3).empty());
  PlantOnBench drive((mock::PlantConfig()));
  Guard guard(drive, kWide);
  ASSERT_TRUE(guard.enable(Loop::velocity));
  EXPECT_FALSE(take_loop_response(guard, plan));
  EXPECT_EQ(drive.plant().velocity_rad_s(), 0.0);
}

TEST(LoopResponse, excitation_comes_up_to_its_offset_without_a_jump) {
  LoopResponsePlan plan = velocity_plan();
  plan.excitation = 0.01;
  const auto values = loop_excitation(plan, 1e-3);
  ASSERT_FALSE(values.empty());
  EXPECT_EQ(values.front(), 0.0);
  for (std::size_t i = 1; i < values.size(); ++i) ASSERT_LT(std::abs(values[i] - values[i - 1]), 0.1) << i;
}

}  // namespace
}  // namespace servogate::bench
