// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "drivers/mock/drive/plant.hpp"

namespace servogate::bench {

/// A plant drawn from ranges of real axes, at a motor of 2.4 N m, with an encoder of 17 to 20 bits and 1 % of
/// the rated torque as noise.
inline mock::PlantConfig random_plant(std::mt19937_64& random, bool coupled) {
  const auto between = [&random](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  mock::PlantConfig p;
  p.counts_per_rev = std::int64_t{1} << (17 + random() % 4);
  p.inertia_kg_m2 = between(3e-4, 2e-3);
  p.coulomb_friction_nm = between(0.2, 0.4);
  p.viscous_friction_nm_s = p.coulomb_friction_nm * between(0.006, 0.015);
  p.stribeck_friction_nm = p.coulomb_friction_nm * between(0.3, 0.6);
  p.stribeck_speed_rad_s = between(3.0, 6.0);
  p.cogging_nm = between(0.08, 0.12);
  p.cogging_periods = static_cast<double>(12 + random() % 37);
  p.torque_noise_nm = 0.01 * p.rated_torque_nm;
  // Of the motor alone: a loop for both masses would rattle in the backlash.
  p.velocity_gain = 400.0 * p.inertia_kg_m2;
  if (coupled) {
    p.load_inertia_kg_m2 = p.inertia_kg_m2 * between(0.5, 2.0);
    const double w = 2.0 * std::numbers::pi * between(30.0, 60.0);  // antiresonance
    p.stiffness_nm_rad = p.load_inertia_kg_m2 * w * w;
    p.damping_nm_s = 2.0 * between(0.04, 0.06) * p.stiffness_nm_rad / w;
    p.backlash_rad = between(1e-2, 3e-2);
  }
  return p;
}

/// As `--plant` of `servogate drive` takes it.
inline std::string plant_words(const mock::PlantConfig& p) {
  std::ostringstream out;
  out.precision(17);
  out << "counts=" << p.counts_per_rev << ",inertia=" << p.inertia_kg_m2
      << ",friction=" << p.coulomb_friction_nm << ",viscous=" << p.viscous_friction_nm_s
      << ",stribeck=" << p.stribeck_friction_nm << ",stribeck-speed=" << p.stribeck_speed_rad_s
      << ",cogging=" << p.cogging_nm << ",cogging-periods=" << p.cogging_periods
      << ",torque-noise=" << p.torque_noise_nm << ",velocity-gain=" << p.velocity_gain;
  if (p.stiffness_nm_rad > 0.0)
    out << ",load-inertia=" << p.load_inertia_kg_m2 << ",stiffness=" << p.stiffness_nm_rad
        << ",damping=" << p.damping_nm_s << ",backlash=" << p.backlash_rad;
  return out.str();
}

}  // namespace servogate::bench
