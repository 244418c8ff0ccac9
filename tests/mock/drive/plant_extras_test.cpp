// SPDX-License-Identifier: Apache-2.0
// What a plant has besides a rigid shaft: cogging, a compliant coupling, backlash, Stribeck, noise, heat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/mock/drive/plant_rig.hpp"

namespace servogate::mock {
namespace {

PlantConfig frictionless() {
  PlantConfig config;
  config.coulomb_friction_nm = config.viscous_friction_nm_s = 0.0;
  config.current_time_constant_s = 0.0;
  return config;
}

PlantConfig two_masses() {
  PlantConfig config = frictionless();
  config.inertia_kg_m2 = 1e-3;
  config.load_inertia_kg_m2 = 3e-3;
  config.stiffness_nm_rad = 500.0;
  return config;
}

TEST(PlantExtras, both_masses_behind_a_spring_accelerate_together_in_the_mean) {
  PlantConfig config = two_masses();
  config.damping_nm_s = 0.2;
  Plant plant(config, kStep);
  run(plant, torque(1000), 0.2);  // 2.4 N m on 4e-3 kg m2: 600 rad/s2
  EXPECT_NEAR(plant.velocity_rad_s(), 120.0, 1.0);
  const double angle = plant.revolutions() * 2.0 * std::numbers::pi;
  EXPECT_NEAR(angle, 0.5 * 600.0 * 0.04, 0.05);
}

TEST(PlantExtras, the_load_hangs_behind_the_motor_by_torque_over_stiffness) {
  PlantConfig config = two_masses();
  config.damping_nm_s = 1.0;
  config.load_torque_nm = 1.0;
  Plant plant(config, kStep);
  ServoCommand hold = torque(0);
  hold.loop = ServoCommand::Loop::position;
  run(plant, hold, 3.0);
  const double motor = static_cast<double>(plant.counts()) / static_cast<double>(config.counts_per_rev);
  const double twist = (motor - plant.revolutions()) * 2.0 * std::numbers::pi;
  EXPECT_NEAR(twist, 1.0 / 500.0, 1e-4);
}

TEST(PlantExtras, the_spring_rings_at_its_resonance_and_keeps_its_energy) {
  const PlantConfig config = two_masses();
  Plant plant(config, kStep);
  for (int i = 0; i < 4; ++i) plant.step(torque(1000));
  const double mean = 2.4 * 4 * kStepS / 4e-3;
  int crossings = 0;
  double lowest = 1e9, highest = -1e9, before = plant.velocity_rad_s() - mean;
  for (int i = 0; i < 4000; ++i) {
    plant.step(torque(0));
    const double swing = plant.velocity_rad_s() - mean;
    crossings += (swing > 0.0) != (before > 0.0) ? 1 : 0;
    before = swing;
    if (i >= 3000) {
      lowest = std::min(lowest, swing);
      highest = std::max(highest, swing);
    }
  }
  const double hertz = std::sqrt(500.0 * (1.0 / 1e-3 + 1.0 / 3e-3)) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(crossings / 2.0, hertz, 0.03 * hertz);  // within one second
  EXPECT_GT(highest - lowest, 0.5 * mean) << "it has died away by itself";
  EXPECT_LT(highest - lowest, 8.0 * mean) << "it has grown by itself";
}

TEST(PlantExtras, a_very_stiff_coupling_is_a_rigid_one) {
  PlantConfig stiff = two_masses(), rigid = two_masses();
  stiff.stiffness_nm_rad = 1e6;
  stiff.damping_nm_s = 1.0;
  rigid.stiffness_nm_rad = 0.0;
  Plant a(stiff, kStep), b(rigid, kStep);
  run(a, torque(500), 0.2);
  run(b, torque(500), 0.2);
  EXPECT_NEAR(a.velocity_rad_s(), b.velocity_rad_s(), 0.01 * b.velocity_rad_s());
}

TEST(PlantExtras, cogging_holds_the_rotor_in_its_poles) {
  PlantConfig config = frictionless();
  config.viscous_friction_nm_s = 0.02;
  config.cogging_nm = 0.5;
  config.cogging_periods = 24.0;
  config.start_rev = 0.2 / 24.0;
  Plant plant(config, kStep);
  run(plant, torque(0), 5.0);
  EXPECT_NEAR(plant.revolutions(), 0.0, 1e-3) << "it has fallen into the pole beside it";
  run(plant, torque(100), 2.0);  // 0.24 N m: held where cogging balances it
  EXPECT_NEAR(plant.revolutions(), std::asin(0.24 / 0.5) / (24.0 * 2.0 * std::numbers::pi), 1e-3);
}

TEST(PlantExtras, the_rated_torque_never_gets_the_motor_too_hot_and_twice_of_it_does) {
  PlantConfig config = frictionless();
  config.viscous_friction_nm_s = 0.05;
  config.thermal_time_s = 2.0;
  Plant rated(config, kStep), twice(config, kStep);
  run(rated, torque(1000), 30.0);
  EXPECT_GT(rated.thermal(), 0.99);
  EXPECT_LE(rated.thermal(), 1.0);
  run(twice, torque(2000), 0.5);
  EXPECT_NEAR(twice.thermal(), 4.0 * (1.0 - std::exp(-0.25)), 0.01);
}

PlantConfig stribeck() {
  PlantConfig config = frictionless();
  config.coulomb_friction_nm = 0.1;
  config.stribeck_friction_nm = 0.06;
  config.stribeck_speed_rad_s = 4.0;
  config.viscous_friction_nm_s = 2e-3;
  return config;
}

ServoCommand turn_at(double rad_s, const PlantConfig& config) {
  ServoCommand c = torque(0);
  c.loop = ServoCommand::Loop::velocity;
  c.velocity = rad_s * static_cast<double>(config.counts_per_rev) / (2.0 * std::numbers::pi);
  return c;
}

TEST(PlantExtras, a_shaft_with_stribeck_friction_breaks_away_above_all_of_it) {
  const PlantConfig config = stribeck();
  Plant held(config, kStep), loose(config, kStep);
  run(held, torque(0.159 / 2.4 * 1000), 1.0);
  EXPECT_EQ(held.counts(), 0);
  run(loose, torque(0.165 / 2.4 * 1000), 2.0);
  EXPECT_GT(loose.velocity_rad_s(), 4.0);
}

TEST(PlantExtras, stribeck_friction_falls_with_speed_to_a_bell) {
  const PlantConfig config = stribeck();
  for (const double speed : {-20.0, -4.0, -2.0, 2.0, 4.0, 20.0}) {
    Plant plant(config, kStep);
    run(plant, turn_at(speed, config), 1.0);
    const double bell = std::exp(-speed * speed / 16.0);
    EXPECT_NEAR(plant.torque_nm(), std::copysign(0.1 + 0.06 * bell, speed) + 2e-3 * speed, 1e-5) << speed;
  }
}

TEST(PlantExtras, the_motor_moves_by_the_backlash_before_the_load_that_friction_holds) {
  PlantConfig config = two_masses();
  config.coulomb_friction_nm = 0.5;  // of the load
  config.damping_nm_s = 0.5;
  config.backlash_rad = 0.02;
  Plant plant(config, kStep);
  const double rad = 2.0 * std::numbers::pi / static_cast<double>(config.counts_per_rev);
  double ends[2];
  for (const int side : {0, 1}) {
    ServoCommand creep = turn_at(side == 0 ? -0.5 : 0.5, config);
    creep.torque_limit_positive = creep.torque_limit_negative = 0.1 / 2.4 * 1000;
    run(plant, creep, 1.0);
    ends[side] = static_cast<double>(plant.counts()) * rad;
  }
  EXPECT_DOUBLE_EQ(plant.revolutions(), 0.0) << "the load has moved";
  EXPECT_NEAR(ends[1] - ends[0], 0.02 + 2.0 * 0.1 / 500.0, 1e-4);
}

TEST(PlantExtras, a_gap_pulls_nothing) {
  PlantConfig config = two_masses();
  config.damping_nm_s = 5.0;
  config.backlash_rad = 0.5;
  Plant plant(config, kStep);
  run(plant, torque(1000), 0.01);
  ASSERT_GT(plant.velocity_rad_s(), 5.0);
  EXPECT_DOUBLE_EQ(plant.revolutions(), 0.0) << "the load moves before the gap is closed";
}

TEST(PlantExtras, backlash_without_a_coupling_is_refused) {
  PlantConfig config = frictionless();
  config.backlash_rad = 0.01;
  EXPECT_THROW(Plant(config, kStep), std::invalid_argument);
}

TEST(PlantExtras, noise_is_in_the_measured_torque_alone_and_the_same_in_every_run) {
  PlantConfig config = frictionless(), quiet = frictionless();
  config.torque_noise_nm = 0.024;
  Plant plant(config, kStep), again(config, kStep), still(quiet, kStep);
  double sum = 0.0, squares = 0.0;
  constexpr int kSteps = 20'000;
  for (int i = 0; i < kSteps; ++i) {
    for (Plant* p : {&plant, &again, &still}) p->step(turn_at(10.0, config));
    ASSERT_EQ(plant.state().torque, again.state().torque);
    ASSERT_EQ(plant.counts(), still.counts()) << "noise has moved the shaft";
    const double off = (plant.state().torque - still.state().torque) * 2.4e-3;
    sum += off;
    squares += off * off;
  }
  EXPECT_NEAR(sum / kSteps, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(squares / kSteps), 0.024, 0.001);
}

TEST(PlantExtras, a_load_that_comes_and_goes_slows_a_spindle_down_for_its_time_and_again_in_each_period) {
  PlantConfig config = frictionless();
  config.inertia_kg_m2 = 1e-2;
  config.dip_torque_nm = 2.0;
  config.dip_period_s = 0.5;
  config.dip_time_s = 0.1;
  Plant plant(config, kStep);
  run(plant, torque(1000), 0.3);  // up to speed, and over the first of them
  double fastest = plant.velocity_rad_s();
  for (int period = 0; period < 2; ++period) {
    run(plant, torque(0), period == 0 ? 0.2 : 0.4);
    EXPECT_NEAR(plant.velocity_rad_s(), fastest, 0.2) << "nothing slows it down between two of them";
    run(plant, torque(0), 0.1);
    EXPECT_NEAR(plant.velocity_rad_s(), fastest - 20.0, 0.2) << "2 N m on 0.01 kg m2 for 0.1 s";
    fastest = plant.velocity_rad_s();
  }
}

TEST(PlantExtras, a_load_that_comes_and_goes_never_turns_a_shaft_back) {
  PlantConfig config = frictionless();
  config.dip_torque_nm = 5.0;
  config.dip_period_s = config.dip_time_s = 1.0;
  Plant plant(config, kStep);
  run(plant, torque(1000), 0.5);
  EXPECT_EQ(plant.velocity_rad_s(), 0.0) << "2.4 N m do not move it";
}

TEST(PlantExtras, an_encoder_with_noise_is_off_by_what_it_may_be_and_no_more_the_same_in_every_run) {
  PlantConfig config = frictionless();
  config.encoder_noise_counts = 3.0;
  Plant plant(config, kStep), again(config, kStep);
  std::int64_t low = 0, high = 0;
  for (int n = 0; n < 4000; ++n) {
    plant.step(torque(100));
    again.step(torque(100));
    const std::int64_t off = plant.state().position - plant.counts();
    EXPECT_EQ(plant.state().position, again.state().position);
    low = std::min(low, off);
    high = std::max(high, off);
  }
  EXPECT_EQ(low, -3);
  EXPECT_EQ(high, 3);
}

}  // namespace
}  // namespace servogate::mock
