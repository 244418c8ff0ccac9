// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "drivers/mock/drive/plant.hpp"

namespace servogate::bench {

/// From where to where a property of a random plant is drawn, evenly by its logarithm: ranges of real axes.
struct PlantRange {
  const char* what;
  double low, high;
};
namespace plant_range {
inline constexpr PlantRange kInertia{"inertia of the motor, kg m2", 3e-4, 2e-3};
inline constexpr PlantRange kCoulomb{"Coulomb friction, N m", 0.2, 0.4};
inline constexpr PlantRange kViscous{"viscous by Coulomb friction, s/rad", 0.006, 0.015};
inline constexpr PlantRange kStribeck{"Stribeck by Coulomb friction", 0.3, 0.6};
inline constexpr PlantRange kStribeckSpeed{"Stribeck speed, rad/s", 3.0, 6.0};
inline constexpr PlantRange kCogging{"cogging, N m", 0.08, 0.12};
inline constexpr PlantRange kLoad{"load by motor inertia", 0.5, 2.0};
inline constexpr PlantRange kAntiresonance{"antiresonance, Hz", 30.0, 60.0};
inline constexpr PlantRange kDamping{"damping ratio at it", 0.04, 0.06};
inline constexpr PlantRange kBacklash{"backlash, rad", 1e-2, 3e-2};
inline constexpr const PlantRange* kAll[] = {&kInertia,       &kCoulomb, &kViscous, &kStribeck,
                                             &kStribeckSpeed, &kCogging, &kLoad,    &kAntiresonance,
                                             &kDamping,       &kBacklash};
}  // namespace plant_range

inline void print_plant_ranges() {
  std::printf("encoder of 17 to 20 bits, cogging 12 to 48 times a turn, 1 %% of 2.4 N m as noise\n");
  for (const PlantRange* r : plant_range::kAll) std::printf("%s: %g to %g\n", r->what, r->low, r->high);
}

/// A plant drawn from these ranges, at a motor of 2.4 N m.
inline mock::PlantConfig random_plant(std::mt19937_64& random, bool coupled) {
  namespace range = plant_range;
  const auto of = [&random](const PlantRange& r) {
    return std::exp(std::uniform_real_distribution<double>(std::log(r.low), std::log(r.high))(random));
  };
  mock::PlantConfig p;
  p.counts_per_rev = std::int64_t{1} << (17 + random() % 4);
  p.inertia_kg_m2 = of(range::kInertia);
  p.coulomb_friction_nm = of(range::kCoulomb);
  p.viscous_friction_nm_s = p.coulomb_friction_nm * of(range::kViscous);
  p.stribeck_friction_nm = p.coulomb_friction_nm * of(range::kStribeck);
  p.stribeck_speed_rad_s = of(range::kStribeckSpeed);
  p.cogging_nm = of(range::kCogging);
  p.cogging_periods = static_cast<double>(12 + random() % 37);
  p.torque_noise_nm = 0.01 * p.rated_torque_nm;
  // Of the motor alone: a loop for both masses would rattle in the backlash.
  p.velocity_gain = 400.0 * p.inertia_kg_m2;
  if (coupled) {
    p.load_inertia_kg_m2 = p.inertia_kg_m2 * of(range::kLoad);
    const double w = 2.0 * std::numbers::pi * of(range::kAntiresonance);
    p.stiffness_nm_rad = p.load_inertia_kg_m2 * w * w;
    p.damping_nm_s = 2.0 * of(range::kDamping) * p.stiffness_nm_rad / w;
    p.backlash_rad = of(range::kBacklash);
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
