// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/at_rest.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kPlaces = 6, kRigidPlaces = 4;
constexpr double kShares[] = {0.3, 0.6};  ///< of what holds the load, with which it is pressed

/// Friction alone stops it: a stiff speed loop could rattle in the backlash.
bool coast_to_rest(Guard& guard, double load_nm) {
  constexpr double kLongest_s = 3.0, kStill_s = 0.1, kStill = 0.1;
  double still = 0.0, filtered = guard.speed_rad_s();
  for (double t = 0.0; t < kLongest_s && still < kStill_s; t += guard.period_s()) {
    if (!guard.step(Loop::torque, load_nm)) return false;
    filtered += 0.3 * (guard.speed_rad_s() - filtered);
    still = std::abs(filtered) < kStill ? still + guard.period_s() : 0.0;
  }
  return true;
}

/// Presses the motor against a load at rest, with what cogging takes given back: it could hold the motor in
/// the middle of the gap.
class Presser {
 public:
  Presser(Guard& guard, const KnownPlant& plant, double motor_inertia, double hold_nm)
      : guard_(guard),
        plant_(plant),
        gain_(kCreepBandwidth * motor_inertia),
        most_(0.3 * hold_nm),
        hold_(hold_nm),
        angle_(guard.answer().position_rad) {
    // So slow that what the motor carries into the load is less than a third of what holds that.
    if (plant.masses.coupling)
      creep_ = 0.3 * hold_nm / std::sqrt(plant.masses.coupling->stiffness_nm_rad * motor_inertia);
    angle_time_s_ = angle_time(plant, motor_inertia);
    creep_ = std::clamp(creep_, 0.02, kFastest);
  }

  /// Lets the coupling go slowly, so that it throws the motor nowhere, and creeps in this direction until it
  /// stands: softly, so that it comes to rest at the load's face.
  bool touch(double side) {
    constexpr double kLongest_s = 2.0, kStill_s = 0.06;
    const double h = guard_.period_s();
    if (!ramp_to(0.0)) return false;
    double filtered = 0.0, still = 0.0, stands_at = guard_.answer().position_rad;
    for (double t = 0.0; t < kLongest_s && still < kStill_s; t += h) {
      const double angle = guard_.answer().position_rad;
      filtered += kSpeedShare * (guard_.speed_rad_s() - filtered);
      torque_ = std::clamp(gain_ * (side * creep_ - filtered), -most_, most_);
      // A free motor is where it will be when this acts; what lags would throw it from pole to pole.
      angle_ = angle + filtered * kDead_cycles * h;
      if (!apply(torque_)) return false;
      still += h;
      if (std::abs(angle - stands_at) < 0.2 * creep_ * kStill_s) continue;
      stands_at = angle;
      still = 0.0;
    }
    return true;
  }

  /// From there to this torque, slowly against any resonance, and waits; where it stands then.
  bool press(double torque, int place, std::vector<Press>& presses) {
    constexpr double kWait_s = 0.2, kLook_s = 0.1;
    const double h = guard_.period_s(), wait = std::max(kWait_s, 2.0 * angle_time_s_);
    if (!ramp_to(torque) || !keep(wait)) return false;
    double angle = 0.0, pressed = 0.0, count = 0.0;
    for (double t = 0.0; t < kLook_s; t += h) {
      if (!ask(torque)) return false;
      angle += guard_.answer().position_rad;
      // What the cogging takes where the motor is, not where it was taken to be.
      pressed += asked_ - cogging_at(guard_.answer().position_rad);
      count += 1.0;
    }
    presses.push_back({pressed / count, angle / count, place});
    return true;
  }

  /// From a press on slowly, until the load moves. Then softly to rest.
  bool break_away(double side, std::vector<FrictionPoint>& out) {
    constexpr double kSlowFrom = 0.85, kMost = 1.4, kRate_s = 0.3;  // of what holds it; that a second
    const double h = guard_.period_s(), rate = kRate_s * hold_;
    if (!ramp_to(side * kSlowFrom * hold_) || !keep(std::max(0.1, 2.0 * angle_time_s_))) return false;
    const std::size_t first = guard_.samples().size();
    const double most = std::min(kMost * hold_, guard_.envelope().torque_nm);
    bool moves = false;
    while (!moves && std::abs(torque_) < most) {
      torque_ += side * rate * h;
      if (!ask(torque_)) return false;
      const double moved = side * load_moved(first);
      moves = moved > least_motion();
      if (moves) note(first, moved, side, rate, out);
    }
    // Less than dry friction has in motion, and no twist that throws the motor back.
    torque_ *= 0.6;
    return keep(0.1) && ramp_to(0.0);
  }

  /// To another place, by a share of the cogging's period: what the cogging is off, is off the other way
  /// there.
  bool move_on(int place, double side) {
    constexpr double kSpeed = 2.0, kGolden = 0.618;
    const double period = plant_.cogging ? kTurn / plant_.cogging->periods : 0.1;
    return guard_.run_at(side * kSpeed, 20.0 * kSpeed, (1.0 + kGolden * place) * period / kSpeed) &&
           guard_.run_at(0.0, 20.0 * kSpeed, 0.0) && coast_to_rest(guard_, plant_.friction.load_nm);
  }

 private:
  /// Of the speed loop on the motor alone, rad/s: slow against the dead time of a bus.
  static constexpr double kCreepBandwidth = 60.0;
  static constexpr double kFastest = 0.2, kSpeedShare = 0.3;
  static constexpr double kDead_cycles =
      4.5;                                   ///< from a position to what is answered to it, and the filter's
  static constexpr double kWindow_s = 0.06;  ///< in which a motion shows

  bool ramp_to(double torque) {
    constexpr double kRamp_s = 0.2;
    const double h = guard_.period_s(), from = torque_;
    for (double t = h; t < kRamp_s; t += h)
      if (!ask(from + (torque - from) * t / kRamp_s)) return false;
    torque_ = torque;
    return true;
  }
  bool keep(double time_s) {
    for (double t = 0.0; t < time_s; t += guard_.period_s())
      if (!ask(torque_)) return false;
    return true;
  }

  double compliance() const {
    return plant_.masses.coupling ? 1.0 / plant_.masses.coupling->stiffness_nm_rad : 0.0;
  }
  /// More than a torque that is rounded, or a count, does.
  double least_motion() const { return 5e-4 + 0.005 * compliance(); }
  /// What the motor has moved beside what the coupling twists under the torque that reaches it.
  double load_moved(std::size_t first) const {
    const auto& s = guard_.samples();
    const auto window = static_cast<std::size_t>(kWindow_s / guard_.period_s());
    const Sample& from = s[std::max(first, s.size() - std::min(s.size(), window + 1))];
    const double twist = (pressed_by(s.back()) - pressed_by(from)) * compliance();
    return s.back().position_rad - from.position_rad - twist;
  }
  double pressed_by(const Sample& s) const { return s.set_point - cogging_at(s.position_rad); }

  /// Beyond what holds it the torque grows evenly, and so does the acceleration: the way by the third power
  /// of the time tells when that began. The torque there is that of a line through all of it.
  void note(std::size_t first, double moved, double side, double rate,
            std::vector<FrictionPoint>& out) const {
    const double h = guard_.period_s();
    const double since = std::min(kWindow_s, std::cbrt(6.0 * plant_.masses.inertia_kg_m2 * moved / rate));
    const auto& s = guard_.samples();
    const std::size_t end = s.size() - std::min(s.size(), static_cast<std::size_t>(since / h));
    if (end < first + 20) return;
    double n = 0.0, t1 = 0.0, t2 = 0.0, y1 = 0.0, ty = 0.0, y2 = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const double t = static_cast<double>(i) - static_cast<double>(end);
      const double y = s[i].torque_nm - cogging_at(s[i].position_rad);
      n += 1.0;
      t1 += t;
      t2 += t * t;
      y1 += y;
      ty += t * y;
      y2 += y * y;
    }
    const double slope = (n * ty - t1 * y1) / (n * t2 - t1 * t1), at_end = (y1 - slope * t1) / n;
    const double variance = std::max(0.0, (y2 - at_end * y1 - slope * ty) / (n - 2.0));
    out.push_back({side * FrictionPoint::kAtRest, at_end,
                   std::max(1e-6, std::sqrt(variance * t2 / (n * t2 - t1 * t1)))});
  }

  /// The angle for the cogging is taken slowly: at the motor's resonance on the coupling the way over the bus
  /// would make a spring of it that swings up. So slowly that what it drives there is half of what the
  /// coupling damps.
  static double angle_time(const KnownPlant& plant, double motor_inertia) {
    constexpr double kLeast_s = 0.03, kMost_s = 0.2;
    const auto& coupling = plant.masses.coupling;
    if (!coupling || !plant.cogging) return kLeast_s;
    const double steepest = plant.cogging->amplitude_nm * plant.cogging->periods;
    const double damps = coupling->stiffness_nm_rad * std::max(coupling->damping_nm_s, 1e-9);
    return std::clamp(2.0 * steepest * motor_inertia / damps, kLeast_s, kMost_s);
  }
  double cogging_at(double angle) const { return plant_.cogging ? plant_.cogging->at(angle) : 0.0; }
  bool ask(double net) {
    angle_ += (1.0 - std::exp(-guard_.period_s() / angle_time_s_)) * (guard_.answer().position_rad - angle_);
    return apply(net);
  }
  bool apply(double net) {
    const double most = guard_.envelope().torque_nm;
    asked_ = std::clamp(net + cogging_at(angle_), -most, most);
    return guard_.step(Loop::torque, asked_);
  }

  Guard& guard_;
  KnownPlant plant_;
  double gain_, creep_ = 0.1, most_, hold_, torque_ = 0.0, asked_ = 0.0, angle_, angle_time_s_ = 0.0;
};

}  // namespace

bool look_at_rest(Guard& guard, const KnownPlant& plant, AtRest& out) {
  if (!coast_to_rest(guard, plant.friction.load_nm)) return false;
  const double hold = plant.friction.breakaway_nm() - std::abs(plant.friction.load_nm);
  if (!(hold > 0.0)) return true;
  const double motor =
      plant.masses.coupling ? plant.masses.coupling->motor_inertia_kg_m2 : plant.masses.inertia_kg_m2;
  Presser presser(guard, plant, motor, hold);
  const int places = plant.masses.coupling ? kPlaces : kRigidPlaces;
  for (int place = 0; place < places; ++place) {
    const double last = place % 2 == 0 ? 1.0 : -1.0;
    for (const double side : {-last, last}) {
      if (!presser.touch(side)) return false;
      if (place > 0 && !plant.masses.coupling) continue;  // a rigid shaft yields nowhere
      for (const double share : kShares)
        if (!presser.press(side * share * hold, place, out.presses)) return false;
    }
    if (!presser.break_away(last, out.breakaways) || !presser.move_on(place, last)) return false;
  }
  return true;
}

}  // namespace servogate::bench
