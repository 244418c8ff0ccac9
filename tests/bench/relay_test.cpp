// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/relay.hpp"

#include <gtest/gtest.h>

#include "tests/bench/plant_on_bench.hpp"

namespace servogate::bench {
namespace {

constexpr Envelope kWide{-10.0, 500.0, 60.0, 2.0, 60.0, 1.0};

mock::PlantConfig plant_of(double inertia) {
  mock::PlantConfig p;
  p.inertia_kg_m2 = inertia;
  p.torque_noise_nm = 0.024;
  return p;
}

TEST(Relay, finds_the_inertia_and_the_dead_time_of_the_way_over_the_bus) {
  for (const double inertia : {3e-4, 1e-3, 2e-3}) {
    PlantOnBench drive(plant_of(inertia));
    Guard guard(drive, kWide);
    RelayPlan plan;
    plan.torque_nm = 0.3;
    plan.speed_rad_s = 15.0;
    ASSERT_TRUE(guard.accepts(Loop::velocity, relay_course(plan, guard.period_s())));
    ASSERT_TRUE(guard.enable(Loop::velocity));
    const auto found = take_relay(guard, plan);
    ASSERT_TRUE(found) << inertia;
    EXPECT_NEAR(found->inertia_kg_m2, inertia, 0.05 * inertia);
    EXPECT_GT(found->dead_time_s, 1.5e-3) << "a cycle on the bus in each direction";
    EXPECT_LT(found->dead_time_s, 6e-3);
    EXPECT_TRUE(guard.release());
  }
}

TEST(Relay, without_torque_enough_finds_nothing_and_leaves_the_drive_off) {
  PlantOnBench drive(plant_of(1e-3));
  Guard guard(drive, kWide);
  RelayPlan plan;
  plan.torque_nm = 1e-4;
  plan.most_s = 1.0;
  ASSERT_TRUE(guard.enable(Loop::velocity));
  EXPECT_FALSE(take_relay(guard, plan));
  EXPECT_TRUE(guard.release());
}

TEST(Relay, its_course_does_not_fit_into_a_short_travel) {
  PlantOnBench drive(plant_of(1e-3));
  Guard guard(drive, {-10.0, 20.0, 60.0, 2.0, 60.0, 1.0});
  EXPECT_FALSE(guard.accepts(Loop::velocity, relay_course({}, guard.period_s())));
  EXPECT_EQ(guard.trip(), Trip::travel);
}

}  // namespace
}  // namespace servogate::bench
