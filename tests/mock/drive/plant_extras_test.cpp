// SPDX-License-Identifier: Apache-2.0
// What a plant has besides a rigid shaft: cogging, a compliant coupling, heat.
#include <gtest/gtest.h>

#include <cmath>
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

}  // namespace
}  // namespace servogate::mock
