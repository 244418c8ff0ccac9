// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/mock/drive/plant_rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

ServoCommand velocity(double counts_s) {
  ServoCommand c = torque(0);
  c.loop = ServoCommand::Loop::velocity;
  c.velocity = counts_s;
  return c;
}
ServoCommand position(double counts, double counts_s = 0.0) {
  ServoCommand c = torque(0);
  c.loop = ServoCommand::Loop::position;
  c.position = counts;
  c.velocity = counts_s;
  return c;
}
TEST(DrivePlant, a_constant_torque_ends_at_the_speed_where_viscous_friction_balances_it) {
  PlantConfig config;
  config.viscous_friction_nm_s = 0.02;
  config.max_speed_rad_s = 1e6;
  Plant plant(config, kStep);
  run(plant, torque(500), 1.0);  // 1.2 N m - 0.1 N m dry = 0.02 * w; time constant 50 ms
  EXPECT_NEAR(plant.velocity_rad_s(), 55.0, 1e-6);
}

TEST(DrivePlant, acceleration_is_torque_less_friction_over_inertia) {
  PlantConfig config;
  config.viscous_friction_nm_s = 0.0;
  config.current_time_constant_s = 0.0;
  Plant plant(config, kStep);
  run(plant, torque(1000), 0.1);  // (2.4 - 0.1) / 1e-3 = 2300 rad/s^2
  EXPECT_NEAR(plant.velocity_rad_s(), 230.0, 1e-6);
  EXPECT_NEAR(plant.revolutions(), 0.5 * 2300 * 0.01 / (2 * std::numbers::pi), 0.01);
}

TEST(DrivePlant, dry_friction_holds_below_its_torque_and_lets_go_above) {
  Plant plant(PlantConfig{}, kStep);
  run(plant, torque(40), 1.0);  // 0.096 N m
  EXPECT_EQ(plant.velocity_rad_s(), 0.0);
  EXPECT_EQ(plant.counts(), 0);
  run(plant, torque(45), 1.0);  // 0.108 N m
  EXPECT_GT(plant.velocity_rad_s(), 1.0);
}

TEST(DrivePlant, without_current_the_shaft_coasts_to_a_stop_and_never_turns_back) {
  Plant plant(PlantConfig{}, kStep);
  run(plant, torque(1000), 0.1);
  double before = plant.velocity_rad_s();
  ServoCommand off;
  off.brake_released = true;
  run(plant, off, 0.01);
  for (int i = 0; i < 20'000; ++i) {
    plant.step(off);
    ASSERT_GE(plant.velocity_rad_s(), 0.0);
    ASSERT_LE(plant.velocity_rad_s(), before + 1e-9);
    before = plant.velocity_rad_s();
  }
  EXPECT_EQ(plant.velocity_rad_s(), 0.0);
}

TEST(DrivePlant, current_follows_its_command_as_a_first_order_lag) {
  PlantConfig config;
  config.current_time_constant_s = 0.01;
  config.coulomb_friction_nm = 100.0;  // the shaft is held
  Plant plant(config, kStep);
  run(plant, torque(1000), 0.01);
  EXPECT_NEAR(plant.torque_nm(), 2.4 * (1 - std::exp(-1.0)), 0.03);
}

TEST(DrivePlant, the_brake_holds_a_hanging_load_and_an_open_one_lets_it_fall) {
  PlantConfig config;
  config.load_torque_nm = 1.5;
  config.brake_torque_nm = 5.0;
  Plant plant(config, kStep);
  ServoCommand off;
  run(plant, off, 1.0);
  EXPECT_EQ(plant.counts(), 0);
  off.brake_released = true;
  run(plant, off, 0.15);
  EXPECT_LT(plant.velocity_rad_s(), -100.0) << "a positive load pulls towards minus";
}

TEST(DrivePlant, a_brake_takes_its_time_to_give_way_and_to_hold) {
  PlantConfig config;
  config.load_torque_nm = 1.5;
  config.brake_torque_nm = 50.0;
  config.brake_release_s = 0.08;
  config.brake_engage_s = 0.04;
  Plant plant(config, kStep);
  ServoCommand off;
  run(plant, off, 0.1);
  off.brake_released = true;
  run(plant, off, 0.079);
  EXPECT_EQ(plant.counts(), 0) << "it still holds";
  run(plant, off, 0.02);
  const double falling = plant.velocity_rad_s();
  EXPECT_LT(falling, -10.0);
  off.brake_released = false;
  run(plant, off, 0.039);
  EXPECT_LT(plant.velocity_rad_s(), falling - 30.0) << "the load falls on until it holds";
  run(plant, off, 0.03);
  EXPECT_EQ(plant.velocity_rad_s(), 0.0);
}

TEST(DrivePlant, the_position_loop_holds_against_a_load_to_the_count) {
  Plant plant(PlantConfig{}, kStep);
  plant.set_load_torque(1.0);
  run(plant, position(12'345), 2.0);
  EXPECT_NEAR(static_cast<double>(plant.counts()), 12'345, 1.0);
  EXPECT_NEAR(plant.torque_nm(), 1.0, 0.11);
}

TEST(DrivePlant, following_error_without_feed_forward_is_speed_over_position_gain) {
  PlantConfig config;
  Plant plant(config, kStep);
  const double speed = 1'000'000;
  double demand = 0.0;
  double error = 0.0;
  for (int i = 0; i < 8000; ++i) {
    plant.step(position(demand));
    demand += speed * kStepS;
    error = demand - static_cast<double>(plant.counts());
  }
  EXPECT_NEAR(error, speed / config.position_gain, 5.0);
}

TEST(DrivePlant, following_error_with_feed_forward_is_a_few_counts) {
  Plant plant(PlantConfig{}, kStep);
  const double speed = 1'000'000;
  double demand = 0.0;
  for (int i = 0; i < 8000; ++i) {
    plant.step(position(demand, speed));
    demand += speed * kStepS;
  }
  EXPECT_NEAR(demand - static_cast<double>(plant.counts()), 0.0, 3.0);
}

TEST(DrivePlant, torque_never_exceeds_the_limit_of_the_command_nor_the_peak) {
  Plant plant(PlantConfig{}, kStep);
  ServoCommand c = velocity(10'000'000);
  c.torque_limit_positive = 700;
  c.torque_limit_negative = 200;
  for (int i = 0; i < 400; ++i) {
    plant.step(c);
    ASSERT_LE(plant.state().torque, 700.001);
  }
  EXPECT_TRUE(plant.state().saturated);
  c.velocity = -10'000'000;
  for (int i = 0; i < 400; ++i) {
    plant.step(c);
    if (i > 20) {
      ASSERT_GE(plant.state().torque, -200.01);
    }
  }
}

TEST(DrivePlant, there_is_no_torque_beyond_the_maximum_speed) {
  PlantConfig config;
  Plant plant(config, kStep);
  run(plant, torque(3000), 2.0);
  EXPECT_LE(plant.velocity_rad_s(), config.max_speed_rad_s * 1.01);
  EXPECT_GE(plant.velocity_rad_s(), config.max_speed_rad_s * 0.97);
}

TEST(DrivePlant, end_stops_hold_the_shaft_and_let_it_leave) {
  PlantConfig config;
  config.end_stop_max_rev = 0.5;
  Plant plant(config, kStep);
  run(plant, torque(300), 0.5);
  EXPECT_TRUE(plant.at_end_stop());
  EXPECT_EQ(plant.counts(), 131'072);
  EXPECT_EQ(plant.velocity_rad_s(), 0.0);
  run(plant, torque(-300), 0.1);
  EXPECT_FALSE(plant.at_end_stop());
  EXPECT_LT(plant.velocity_rad_s(), 0.0);
}

TEST(DrivePlant, energy_grows_only_by_what_the_motor_puts_in) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  Plant plant(PlantConfig{}, kStep);
  ServoCommand c = torque(0);
  for (int i = 0; i < 50'000; ++i) {
    if (i % 100 == 0) c.torque = static_cast<double>(random() % 2001) - 1000.0;
    const double before = plant.kinetic_energy(), w0 = plant.velocity_rad_s();
    plant.step(c);
    const double w1 = plant.velocity_rad_s();
    // Work of the torque over the angle of the step, taken at the larger speed.
    const double put_in = std::max(plant.torque_nm() * w0, plant.torque_nm() * w1) * kStepS;
    ASSERT_LE(plant.kinetic_energy() - before, put_in + 1e-6);
  }
}

TEST(DrivePlant, the_zero_mark_appears_once_a_turn_in_both_directions_at_its_place) {
  PlantConfig config;
  config.zero_mark_counts = 77;
  Plant plant(config, kStep);
  int marks = 0;
  for (int i = 0; i < 4000; ++i) {
    plant.step(velocity(2'621'440));
    if (!plant.state().zero_mark) continue;
    ++marks;
    EXPECT_EQ(plant.state().zero_mark_position, 77 + (marks - 1) * 262'144);
  }
  EXPECT_NEAR(marks, 10, 1);
  const int there = marks;
  while (plant.counts() > 0) {
    plant.step(velocity(-2'621'440));
    if (plant.state().zero_mark) {
      EXPECT_EQ(plant.state().zero_mark_position, 77 + (--marks) * 262'144);
    }
  }
  EXPECT_EQ(marks, 0) << "of " << there;
}

TEST(DrivePlant, loops_are_stable_and_well_damped_over_a_range_of_inertias_and_steps) {
  for (const double inertia : {1e-5, 1e-4, 1e-3, 1e-2}) {
    for (const image::Nanoseconds step : {62'500, 125'000, 250'000}) {
      PlantConfig config;
      config.inertia_kg_m2 = inertia;
      config.coulomb_friction_nm = 0.0;
      Plant plant(config, step);
      const double target = 100;  // small: no saturation
      double highest = 0.0;
      for (double t = 0; t < 0.5; t += static_cast<double>(step) * 1e-9) {
        plant.step(position(target));
        highest = std::max(highest, static_cast<double>(plant.counts()));
      }
      EXPECT_LT(highest, target * 1.25) << inertia << " " << step;
      EXPECT_NEAR(static_cast<double>(plant.counts()), target, 2.0) << inertia << " " << step;
    }
  }
}

TEST(DrivePlant, senseless_settings_are_refused) {
  PlantConfig config;
  config.inertia_kg_m2 = 0.0;
  EXPECT_THROW(Plant(config, kStep), std::invalid_argument);
  EXPECT_THROW(Plant(PlantConfig{}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace servogate::mock
