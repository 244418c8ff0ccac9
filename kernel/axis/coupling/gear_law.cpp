// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/coupling/gear_law.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/law/master.hpp"

namespace servogate::axis {
namespace {

constexpr double kLeast = 0.01;    // of a limit, where the master takes all of it
constexpr double kFrames = 0.9;    // of the acceleration, the most that the way there reckons with
constexpr double kSettling = 3.0;  // times the jerk that each part of the settling may ask for

/// The highest acceleration at the end of the cycle from which the speed stays below `most`.
double highest(double v, double a, double most, double jerk, double dt) noexcept {
  const double over = v + 0.5 * a * dt - most;
  const double root = 0.25 * dt * dt - 2.0 * over / jerk;
  return root > 0.0 ? std::max(0.0, jerk * (std::sqrt(root) - 0.5 * dt)) : 0.0;
}

/// The jerk that is wanted, or what of it keeps the limits in this cycle and can keep them in those to come.
double within(double jerk, const MotionState& s, const MotionLimits& m, double dt) noexcept {
  const double up = std::min(m.acceleration, highest(s.v, s.a, m.velocity, m.jerk, dt));
  const double down = std::min(m.acceleration, highest(-s.v, -s.a, m.velocity, m.jerk, dt));
  const double a = std::clamp(s.a + jerk * dt, -down, up);
  return std::clamp((a - s.a) / dt, -m.jerk, m.jerk);
}

/// A master's set-point of the next cycle is one that the axis may take. Joining it, the axis has to be there
/// already; along with it the jerk may change within a cycle.
bool may_take(const MotionState& from, const MotionState& next, const MotionLimits& m, double dt,
              bool joins) noexcept {
  constexpr double kJoins = 1e-4, kSlack = 1.001;
  const auto near = [](double off, double most) { return std::abs(off) <= most * kSlack; };
  const double change = m.jerk * dt, off = (joins ? kJoins : 1.0) * change;
  // Not followed any further it could still keep its speed.
  const double settled = next.v + 0.5 * next.a * std::abs(next.a) / m.jerk;
  return near(next.v, m.velocity) && near(settled, m.velocity) && near(next.a, m.acceleration) &&
         near(next.a - from.a, change) && near(next.v - from.v - 0.5 * dt * (from.a + next.a), off * dt) &&
         near(next.x - from.x - dt * (from.v + dt * (from.a / 3.0 + next.a / 6.0)), off * dt * dt);
}

/// The quickest way onto the place, in coordinates that move with it.
double onto(const MotionState& from, const GearTarget& target, const MotionLimits& m, double dt) noexcept {
  const double moved = std::clamp(target.now.a, -kFrames * m.acceleration, kFrames * m.acceleration);
  const MotionState off{from.x - target.now.x, from.v - target.now.v, from.a - moved};
  const MotionLimits left{std::max(m.velocity - std::abs(target.now.v), kLeast * m.velocity),
                          std::max(m.acceleration - std::abs(moved), kLeast * m.acceleration), m.jerk};
  Ramp ramp;
  ramp.reset(off, left);
  if (target.placed)
    ramp.move_to(0.0, left);
  else
    ramp.move_at(0.0, left);
  return (ramp.step(dt).a - off.a) / dt;
}

}  // namespace

double GearLaw::at_speed(const MotionLimits& m) noexcept {
  constexpr double k = path::kMasterSettles;
  return std::max(m.jerk / (3.0 * k * k), 0.002 * m.velocity);
}

MotionState GearLaw::step(const MotionState& from, const GearTarget& target, const MotionLimits& m,
                          double dt) noexcept {
  takes_ = target.exact && target.placed && may_take(from, target.next, m, dt, !takes_);
  if (takes_) return target.next;
  constexpr double k = path::kMasterSettles;
  const double s = target.placed ? target.now.x - from.x : 0.0, v = target.now.v - from.v,
               a = target.now.a - from.a;
  const double most = kSettling * m.jerk;
  const bool near =
      k * k * k * std::abs(s) <= most && 3.0 * k * k * std::abs(v) <= most && 3.0 * k * std::abs(a) <= most;
  const double wanted = near ? path::settling_jerk(s, v, a) : onto(from, target, m, dt);
  const double j = within(wanted, from, m, dt);
  return {from.x + dt * (from.v + dt * (0.5 * from.a + dt * j / 6.0)), from.v + dt * (from.a + 0.5 * dt * j),
          from.a + dt * j};
}

}  // namespace servogate::axis
