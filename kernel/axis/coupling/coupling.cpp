// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/coupling/coupling.hpp"

#include <cmath>
#include <cstdlib>
#include <numeric>

namespace servogate::axis {
namespace {

constexpr double kSettles = 0.05;  // s inside of half the window until it counts as synchronous

}  // namespace

void Coupling::begin(const CouplingOrder& order, ComesRound round) noexcept {
  on_ = true;
  placed_ = synchronous_ = false;
  ratio_ = static_cast<double>(order.follower_turns) / static_cast<double>(order.leader_turns);
  phase_ = order.phase_deg / 360.0;
  shift_ = inside_s_ = 0.0;
  const auto equal =
      static_cast<double>(order.leader_turns / std::gcd(order.leader_turns, std::abs(order.follower_turns)));
  spacing_ = round == ComesRound::both       ? 1.0 / equal
             : round == ComesRound::leader   ? std::abs(ratio_)
             : round == ComesRound::follower ? 1.0
                                             : 0.0;
}

double Coupling::to_nearest(double behind) const noexcept {
  return spacing_ > 0.0 ? behind - std::round(behind / spacing_) * spacing_ : behind;
}

void Coupling::choose(double behind) noexcept { capture(behind - to_nearest(behind)); }

void Coupling::capture(double behind) noexcept {
  shift_ -= behind;
  placed_ = true;
  inside_s_ = 0.0;
}

bool Coupling::watch(double behind, double window_deg, double dt) noexcept {
  const double off = 360.0 * std::abs(behind);
  inside_s_ = off <= 0.5 * window_deg ? inside_s_ + dt : 0.0;
  if (synchronous_ && off > window_deg) {
    synchronous_ = false;
    return true;
  }
  synchronous_ = synchronous_ || inside_s_ >= kSettles;
  return false;
}

}  // namespace servogate::axis
