// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/identify.hpp"

#include <gtest/gtest.h>

#include "tests/bench/plant_on_bench.hpp"
#include "tests/bench/random_plant.hpp"
#include "tests/property_seed.hpp"

namespace servogate::bench {
namespace {

constexpr double kShare = 0.03;

void expect_within(double found, double truth, const char* what) {
  EXPECT_NEAR(found, truth, kShare * std::abs(truth)) << what;
}

TEST(Identify, finds_random_plants_within_three_per_cent) {
  std::mt19937_64 random(test::property_seed());
  print_plant_ranges();
  for (int i = 0; i < 10; ++i) {
    const mock::PlantConfig p = random_plant(random, i % 2 == 1);
    SCOPED_TRACE(plant_words(p));
    PlantOnBench drive(p);
    Guard guard(drive, {-100.0, 2500.0, 120.0, 4.8, 100.0, 1.0});
    ASSERT_TRUE(guard.enable(Loop::velocity));
    std::string why;
    const auto found = identify(guard, {}, why);
    ASSERT_TRUE(found) << why << static_cast<int>(guard.trip()) << " at " << guard.stages().back();
    expect_within(found->masses.inertia_kg_m2, p.inertia_kg_m2 + p.load_inertia_kg_m2, "inertia");
    expect_within(found->friction.coulomb_nm, p.coulomb_friction_nm, "Coulomb");
    expect_within(found->friction.viscous_nm_s, p.viscous_friction_nm_s, "viscous");
    expect_within(found->friction.breakaway_nm(), p.coulomb_friction_nm + p.stribeck_friction_nm,
                  "breakaway");
    ASSERT_TRUE(found->cogging);
    EXPECT_EQ(found->cogging->periods, p.cogging_periods);
    expect_within(found->cogging->amplitude_nm, p.cogging_nm, "cogging");
    ASSERT_EQ(found->masses.coupling.has_value(), p.stiffness_nm_rad > 0.0);
    if (!found->masses.coupling) continue;
    const double turn = 2.0 * std::numbers::pi;
    expect_within(found->masses.coupling->antiresonance_hz,
                  std::sqrt(p.stiffness_nm_rad / p.load_inertia_kg_m2) / turn, "antiresonance");
    expect_within(found->masses.coupling->resonance_hz,
                  std::sqrt(p.stiffness_nm_rad * (1.0 / p.load_inertia_kg_m2 + 1.0 / p.inertia_kg_m2)) / turn,
                  "resonance");
    ASSERT_TRUE(found->lost_motion);
    expect_within(found->lost_motion->backlash_rad, p.backlash_rad, "backlash");
  }
}

TEST(Identify, does_not_begin_without_the_travel_that_it_needs) {
  PlantOnBench drive((mock::PlantConfig()));
  Guard guard(drive, {-1.0, 1.0, 120.0, 4.8, 100.0, 1.0});
  std::string why;
  EXPECT_FALSE(identify(guard, {}, why));
  EXPECT_EQ(guard.trip(), Trip::travel);
  EXPECT_FALSE(drive.asked.power);
}

}  // namespace
}  // namespace servogate::bench
