// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "bench/drive/identification/cogging.hpp"
#include "bench/drive/identification/friction.hpp"
#include "bench/drive/identification/lost_motion.hpp"
#include "bench/drive/identification/masses.hpp"
#include "tests/property_seed.hpp"

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kShare = 0.03;

double between(std::mt19937_64& random, double low, double high) {
  return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
}

std::vector<FrictionPoint> points_of(const FrictionCurve& truth, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> off(0.0, noise);
  std::vector<FrictionPoint> points;
  for (int i = 0; i < 10; ++i)
    for (const double side : {1.0, -1.0}) {
      const double speed = side * 0.5 * std::pow(200.0, i / 9.0);
      points.push_back({speed, truth.at(speed) + off(random), noise});
    }
  return points;
}

TEST(FrictionFit, finds_random_curves_within_three_per_cent_under_noise) {
  const auto seed = test::property_seed();
  std::mt19937_64 random(seed);
  for (int trial = 0; trial < 200; ++trial) {
    FrictionCurve truth;
    truth.coulomb_nm = between(random, 0.05, 0.5);
    truth.viscous_nm_s = between(random, 0.3, 2.0) * truth.coulomb_nm / 100.0;
    truth.stribeck_nm = between(random, 0.3, 0.8) * truth.coulomb_nm;
    truth.stribeck_speed_rad_s = between(random, 2.0, 8.0);
    truth.load_nm = between(random, 0.01, 0.1);
    const auto fit = fit_friction(points_of(truth, 0.002 * truth.coulomb_nm, random));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->coulomb_nm, truth.coulomb_nm, kShare * truth.coulomb_nm) << seed;
    EXPECT_NEAR(fit->viscous_nm_s, truth.viscous_nm_s, kShare * truth.viscous_nm_s) << seed;
    EXPECT_NEAR(fit->breakaway_nm(), truth.breakaway_nm(), kShare * truth.breakaway_nm()) << seed;
    EXPECT_NEAR(fit->stribeck_speed_rad_s, truth.stribeck_speed_rad_s, kShare * truth.stribeck_speed_rad_s)
        << seed;
  }
}

TEST(FrictionFit, shows_no_stribeck_where_there_is_none) {
  std::mt19937_64 random(3);
  const FrictionCurve truth{0.1, 1e-3, 0.0, 0.0, 0.0, 0.0};
  int shown = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto fit = fit_friction(points_of(truth, 5e-4, random));
    ASSERT_TRUE(fit);
    shown += fit->stribeck_nm != 0.0 ? 1 : 0;
    EXPECT_NEAR(fit->coulomb_nm, 0.1, 0.003);
  }
  EXPECT_LE(shown, 3);
}

TEST(FrictionFit, needs_both_directions) {
  std::vector<FrictionPoint> points;
  for (int i = 1; i < 9; ++i) points.push_back({1.0 * i, 0.1, 0.001});
  EXPECT_FALSE(fit_friction(points));
}

FrequencyResponse response_with(const Masses& truth, double noise, std::mt19937_64& random, double to_hz) {
  std::normal_distribution<double> off(0.0, noise);
  FrequencyResponse h;
  for (double hz = 2.0; hz <= to_hz; hz += 1.0)
    h.lines.push_back({hz, response_of(truth, hz) * (1.0 + Complex(off(random), off(random))), 0.99});
  h.valid_from_hz = 2.0;
  h.valid_to_hz = to_hz;
  return h;
}

TEST(MassesFit, finds_random_pairs_of_masses_within_three_per_cent_under_noise_and_delay) {
  const auto seed = test::property_seed();
  std::mt19937_64 random(seed);
  for (int trial = 0; trial < 50; ++trial) {
    Masses truth;
    Coupling c;
    c.motor_inertia_kg_m2 = between(random, 1e-4, 1e-2);
    c.load_inertia_kg_m2 = between(random, 0.4, 4.0) * c.motor_inertia_kg_m2;
    const double anti = between(random, 25.0, 60.0);
    c.stiffness_nm_rad = c.load_inertia_kg_m2 * std::pow(kTurn * anti, 2);
    c.damping_nm_s = 2.0 * between(random, 0.01, 0.06) * c.stiffness_nm_rad / (kTurn * anti);
    truth.coupling = c;
    truth.inertia_kg_m2 = c.motor_inertia_kg_m2 + c.load_inertia_kg_m2;
    truth.viscous_nm_s = 2.0 * truth.inertia_kg_m2;
    truth.delay_s = 4e-4;
    const auto fit = fit_masses(response_with(truth, 0.05, random, 180.0));
    ASSERT_TRUE(fit && fit->coupling) << seed << " trial " << trial;
    EXPECT_NEAR(fit->inertia_kg_m2, truth.inertia_kg_m2, kShare * truth.inertia_kg_m2) << seed;
    EXPECT_NEAR(fit->coupling->antiresonance_hz, anti, kShare * anti) << seed;
    const double resonance = anti * std::sqrt(1.0 + c.load_inertia_kg_m2 / c.motor_inertia_kg_m2);
    EXPECT_NEAR(fit->coupling->resonance_hz, resonance, kShare * resonance) << seed;
  }
}

TEST(MassesFit, calls_a_rigid_mass_rigid) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    Masses truth;
    truth.inertia_kg_m2 = between(random, 1e-5, 1e-1);
    truth.viscous_nm_s = truth.inertia_kg_m2;
    const auto fit = fit_masses(response_with(truth, 0.05, random, 120.0));
    ASSERT_TRUE(fit);
    EXPECT_FALSE(fit->coupling);
    EXPECT_NEAR(fit->inertia_kg_m2, truth.inertia_kg_m2, kShare * truth.inertia_kg_m2);
  }
}

TEST(MassesFit, finds_the_delay_of_a_phase) {
  FrequencyResponse h;
  for (double hz = 2.0; hz < 200.0; hz += 2.0)
    h.lines.push_back({hz, std::polar(0.9, -kTurn * hz * 0.0032), 1.0});
  EXPECT_NEAR(delay_of(h).value_or(0.0), 0.0032, 1e-9);
}

TEST(CoggingFit, finds_periods_amplitude_and_phase_beside_noise_and_an_uneven_speed) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0.0, 0.02);
  const Cogging truth{0.04, 36, 0.7};
  const double inertia = 1e-3;
  std::vector<double> angle, torque;
  double a = 1.0, v = 6.0;
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 15'000; ++i) {
    const double t = 0.1 + 0.1 * (6.0 - v) + 0.01 * std::sin(300.0 * i * kStep);  // a soft speed loop
    v += kStep * (t - 0.1 - truth.at(a)) / inertia;
    a += kStep * v;
    if (i % 10 != 0) continue;
    angle.push_back(a);
    torque.push_back(t + noise(random));
  }
  Masses masses;
  masses.inertia_kg_m2 = inertia;
  const EvenRun run{angle, torque};
  const auto rough = find_cogging(std::span(&run, 1));
  ASSERT_TRUE(rough);
  FrictionCurve friction;
  friction.coulomb_nm = 0.1;
  const auto fit = size_cogging(std::span(&run, 1), masses, friction, rough->periods);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->periods, 36);
  EXPECT_NEAR(fit->amplitude_nm, 0.04, 0.04 * 0.06);
  EXPECT_NEAR(fit->phase_rad, 0.7, 0.06);
}

TEST(CoggingFit, claims_none_where_there_is_noise_alone_and_none_of_less_than_a_turn) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<double> angle, torque;
  for (int i = 0; i < 3000; ++i) {
    angle.push_back(0.004 * i);
    torque.push_back(0.1 + noise(random));
  }
  const std::span<const double> a(angle), t(torque);
  const EvenRun whole{a, t}, part{a.first(1000), t.first(1000)};
  EXPECT_FALSE(find_cogging(std::span(&whole, 1)));
  EXPECT_FALSE(find_cogging(std::span(&part, 1)));
}

TEST(LostMotionFit, parts_backlash_from_twist) {
  std::vector<Press> presses;
  for (const double torque : {0.05, 0.1, -0.05, -0.1})
    presses.push_back({torque, 1.0 + std::copysign(0.004, torque) + torque / 300.0});
  const auto fit = fit_lost_motion(presses);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->backlash_rad, 0.008, 1e-9);
  EXPECT_NEAR(fit->stiffness_nm_rad, 300.0, 1e-6);
}

TEST(LostMotionFit, leaves_out_places_where_the_load_gave_way) {
  std::vector<Press> presses;
  for (int place = 0; place < 6; ++place)
    for (const double torque : {0.05, 0.1, -0.05, -0.1}) {
      const double gave_way = place >= 4 && torque < 0.0 ? 0.005 * place : 0.0;
      const double off = 1e-5 * (place % 3);
      presses.push_back(
          {torque, 0.3 * place + std::copysign(0.004, torque) + torque / 300.0 - gave_way + off, place});
    }
  const auto fit = fit_lost_motion(presses);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->backlash_rad, 0.008, 1e-6);
  EXPECT_NEAR(fit->stiffness_nm_rad, 300.0, 1e-6) << "where the load stands does not matter to the twist";
}

TEST(FrictionFit, goes_by_what_moves_it_from_rest_where_slow_speeds_stick_and_slip) {
  const FrictionCurve truth{0.37, 0.0025, 0.0, 0.18, 3.9, 0.0};
  std::vector<FrictionPoint> points;
  for (const double side : {1.0, -1.0}) {
    for (const double speed : {1.0, 1.8, 3.2, 5.6, 10.0, 18.0, 32.0, 56.0, 100.0}) {
      // Sticking and slipping, it has the friction of neither its mean speed nor of rest.
      const double off = speed == 1.8 ? -0.04 : speed == 5.6 ? 0.035 : 0.0;
      points.push_back({side * speed, truth.at(side * speed) + side * off, 0.004});
    }
    points.push_back({side * FrictionPoint::kAtRest, truth.at(side * FrictionPoint::kAtRest), 0.002});
  }
  const auto fit = fit_friction(points);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->breakaway_nm(), truth.breakaway_nm(), 0.01 * truth.breakaway_nm());
  EXPECT_NEAR(fit->coulomb_nm, truth.coulomb_nm, 0.02 * truth.coulomb_nm);
  EXPECT_NEAR(fit->viscous_nm_s, truth.viscous_nm_s, 0.05 * truth.viscous_nm_s);
}

TEST(LostMotionFit, claims_no_backlash_within_its_scatter) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> off(0.0, 2e-4);
  int claimed = 0;
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Press> presses;
    for (int place = 0; place < 6; ++place)
      for (const double torque : {0.05, 0.1, -0.05, -0.1})
        presses.push_back({torque, place + torque / 100.0 + off(random), place});
    const auto fit = fit_lost_motion(presses);
    claimed += fit && fit->backlash_rad > 0.0 ? 1 : 0;
  }
  EXPECT_LE(claimed, 3);
  const std::vector<Press> one_sided = {{0.1, 0.0}, {0.2, 0.1}, {0.3, 0.2}, {0.4, 0.3}};
  EXPECT_FALSE(fit_lost_motion(one_sided)) << "one direction tells no backlash";
}

}  // namespace
}  // namespace servogate::bench
