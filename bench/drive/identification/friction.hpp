// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

namespace servogate::bench {

/// Mean torque at an even speed, or torque that moves it from rest.
struct FrictionPoint {
  static constexpr double kAtRest = 1e-9;  ///< rad/s, with the sign of the motion that begins
  double speed_rad_s = 0.0;
  double torque_nm = 0.0;
  double deviation_nm = 1e-3;  ///< standard deviation of that mean, above 0
};

/// Torque at an even speed w: load + sign(w) (coulomb + stribeck exp(-(w / stribeck_speed)^2)) + viscous w.
/// Source of the form: Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30 (1994), (5).
struct FrictionCurve {
  double coulomb_nm = 0.0, viscous_nm_s = 0.0, load_nm = 0.0;
  double stribeck_nm = 0.0, stribeck_speed_rad_s = 0.0;  ///< both 0: the points show none
  double residual_nm = 0.0;                              ///< root mean square of what it leaves
  double at(double speed_rad_s) const noexcept;
  /// Torque that moves it from rest.
  double breakaway_nm() const noexcept { return coulomb_nm + stribeck_nm; }
};

/// By least squares, from at least five points with speeds of both signs; nullopt: fewer. Stribeck is shown
/// when it is at least four standard deviations. Not real-time safe.
std::optional<FrictionCurve> fit_friction(std::span<const FrictionPoint> points);

}  // namespace servogate::bench
