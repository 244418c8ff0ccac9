// SPDX-License-Identifier: Apache-2.0
// `servogate bench identify` on random plants in other processes, seen only through the bus.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/bench/random_plant.hpp"
#include "tests/canopen_tools/lockstep_bench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::canopen_tools {
namespace {

/// The parameter: which plant of the seed.
class RandomPlant : public LockstepBench, public ::testing::WithParamInterface<int> {};

void expect_within(const json& found, double truth, const char* what) {
  ASSERT_TRUE(found.is_number()) << what;
  std::printf("%s: %.2f %% off\n", what, 100.0 * (found.get<double>() / truth - 1.0));
  EXPECT_NEAR(found.get<double>(), truth, 0.03 * std::abs(truth)) << what;
}

TEST_P(RandomPlant, is_identified_within_three_per_cent) {
  std::mt19937_64 random(test::property_seed("SERVOGATE_PLANT_SEED"));
  bench::print_plant_ranges();
  mock::PlantConfig p;
  for (int i = 0; i <= GetParam(); ++i) p = bench::random_plant(random, i % 2 == 1);
  SCOPED_TRACE(bench::plant_words(p));
  const Ended ended =
      bench("identify $DRIVE --travel -100..500 --speed 20 --torque 4.8 --time 120 --i-may-move",
            bench::plant_words(p));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json found = meta();
  EXPECT_EQ(found["off"], true);
  expect_within(found["inertia_kg_m2"], p.inertia_kg_m2 + p.load_inertia_kg_m2, "inertia");
  expect_within(found["friction"]["coulomb_nm"], p.coulomb_friction_nm, "Coulomb");
  expect_within(found["friction"]["viscous_nm_s_rad"], p.viscous_friction_nm_s, "viscous");
  expect_within(found["friction"]["breakaway_nm"], p.coulomb_friction_nm + p.stribeck_friction_nm,
                "breakaway");
  ASSERT_TRUE(found.contains("cogging"));
  EXPECT_EQ(found["cogging"]["periods"], p.cogging_periods);
  expect_within(found["cogging"]["amplitude_nm"], p.cogging_nm, "cogging");
  ASSERT_EQ(found.contains("coupling"), p.stiffness_nm_rad > 0.0);
  if (p.stiffness_nm_rad == 0.0) return;
  const double turn = 2.0 * std::numbers::pi;
  expect_within(found["coupling"]["antiresonance_hz"],
                std::sqrt(p.stiffness_nm_rad / p.load_inertia_kg_m2) / turn, "antiresonance");
  expect_within(found["coupling"]["resonance_hz"],
                std::sqrt(p.stiffness_nm_rad * (1.0 / p.load_inertia_kg_m2 + 1.0 / p.inertia_kg_m2)) / turn,
                "resonance");
  ASSERT_TRUE(found.contains("lost_motion"));
  expect_within(found["lost_motion"]["backlash_rad"], p.backlash_rad, "backlash");
}

INSTANTIATE_TEST_SUITE_P(Ten, RandomPlant, ::testing::Range(0, 10));

}  // namespace
}  // namespace servogate::canopen_tools
