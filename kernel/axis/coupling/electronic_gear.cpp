// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/coupling/electronic_gear.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::axis {
namespace {

constexpr double kTurn = 360.0;        // degrees
constexpr double kRampOf = 0.8;        // of the follower's acceleration, for a spindle that leads
constexpr double kLagsBy = 0.3;        // of the window, where that acceleration begins
constexpr double kSpeedSlack = 1.001;  // paths keep their limits to 0.1 %
constexpr double kPatience = 10.0;     // s besides its ramps, until a follower is in step

double unit_of(const AxisConfig& axis) noexcept { return axis.rotary ? kTurn : 1.0; }
bool comes_round(const AxisConfig& axis) noexcept { return axis.rotary && !axis.travel_limited; }
bool faulty(const image::DriveFeedback& drive) noexcept {
  return !drive.online || drive.state == image::DriveState::fault ||
         drive.state == image::DriveState::fault_reaction_active;
}

}  // namespace

void ElectronicGear::configure(const ElectronicGearConfig& config, std::span<const Axis> axes) {
  *this = ElectronicGear{};
  config_ = config;
  const AxisConfig& f = axes[static_cast<std::size_t>(config.follower)].config();
  const AxisConfig* master =
      config.master_axis < 0 ? nullptr : &axes[static_cast<std::size_t>(config.master_axis)].config();
  unit_ = unit_of(f);
  master_unit_ = master == nullptr ? 1.0 : unit_of(*master);
  const bool leader = master == nullptr || comes_round(*master);
  round_ = leader           ? comes_round(f) ? ComesRound::both : ComesRound::leader
           : comes_round(f) ? ComesRound::follower
                            : ComesRound::neither;
  const double phase_deg = kTurn * config.phase.value_or(0.0) / unit_;
  link_.begin({config.master_turns, config.follower_turns, phase_deg}, round_);
  link_.end();
}

/// What the follower measures in this cycle was latched at the begin of the last one, and so is an axis that
/// leads.
void ElectronicGear::look(const Machine& m, const image::ProcessImage& image) noexcept {
  const image::CycleTime& now = image.now;
  const int delay = follower(m).config().feedback_delay;
  path::MasterReading reading;
  reading.acts_ns = now.t_ns + (delay - 1) * now.period_ns;
  if (const Spindle* s = leading_spindle(m); s != nullptr) {
    master_powered_ =
        s->is_spindle() && !faulty(image.spindles[static_cast<std::size_t>(config_.master_spindle)].drive);
    master_there_ = master_powered_ && s->angle().valid;
    rests_ = s->rests();
    reading.part = static_cast<double>(s->angle().turns) + s->angle().part;
    reading.at_ns = s->angle().at_ns;
  } else {
    const Axis& a = m.axes[static_cast<std::size_t>(config_.master_axis)];
    const image::DriveFeedback& drive = image.axes[static_cast<std::size_t>(config_.master_axis)].drive;
    master_there_ = a.homed() && !a.asleep() && !a.homing().active() && !faulty(drive);
    master_powered_ = master_there_;
    reading.part = a.actual() / master_unit_;
    reading.at_ns = drive.missed == 0 ? now.t_ns - now.period_ns : link_.estimate().read_at();
  }
  reading.valid = master_there_;
  link_.look(reading);
  const path::MasterEstimate& estimate = link_.estimate();
  measured_turns_ =
      config_.master_axis >= 0 && estimate.fresh() ? reading.part : estimate.at(now.t_ns - now.period_ns).n;
}

void ElectronicGear::lead(const Machine& m) const noexcept {
  if (!on_ || config_.master_spindle < 0) return;
  const MotionLimits& limits = follower(m).config().limits;
  // Its acceleration comes at once, the follower's by its jerk: what it lags meanwhile is made good.
  const double begins = std::cbrt(kLagsBy * config_.window * limits.jerk * limits.jerk);
  const double most = std::min(kRampOf * limits.acceleration, begins) / unit_ / std::abs(link_.ratio());
  LeadDemand demand;
  demand.by_setpoint = config_.by == CouplingBy::setpoint;
  demand.in_step = link_.synchronous();
  demand.rpm_s = 60.0 * most;
  m.spindles[static_cast<std::size_t>(config_.master_spindle)].lead(demand);
}

MotionState ElectronicGear::led_to(double turns, double turns_s, double turns_s2) const noexcept {
  const double per_turn = unit_ * link_.ratio();
  return {unit_ * link_.place(turns), per_turn * turns_s, per_turn * turns_s2};
}

double ElectronicGear::speed_asked(std::span<const Axis> axes,
                                   std::span<const Spindle> spindles) const noexcept {
  if (rests_) return 0.0;
  double turns_s = 0.0;
  if (config_.by == CouplingBy::measured)
    turns_s = link_.estimate().at(link_.estimate().read_at()).w;
  else if (config_.master_spindle >= 0)
    turns_s = spindles[static_cast<std::size_t>(config_.master_spindle)].actual_rpm() / 60.0;
  else
    turns_s = axes[static_cast<std::size_t>(config_.master_axis)].setpoint().v / master_unit_;
  return unit_ * static_cast<double>(config_.follower_turns) / static_cast<double>(config_.master_turns) *
         turns_s;
}

double ElectronicGear::off_place(std::span<const Axis> axes) const noexcept {
  if (!config_.phase || round_ != ComesRound::neither) return 0.0;
  const double turns = axes[static_cast<std::size_t>(config_.master_axis)].setpoint().x / master_unit_;
  const double place = *config_.phase + unit_ * static_cast<double>(config_.follower_turns) * turns /
                                            static_cast<double>(config_.master_turns);
  return axes[static_cast<std::size_t>(config_.follower)].setpoint().x - place;
}

bool ElectronicGear::engage(const Machine& m) noexcept {
  Axis& f = follower(m);
  if (!f.engage()) return false;
  const double phase_deg = kTurn * config_.phase.value_or(0.0) / unit_;
  link_.begin({config_.master_turns, config_.follower_turns, phase_deg}, round_);
  law_.begin();
  on_ = true;
  rest_place_ = f.setpoint().x;
  phase_error_ = apart_s_ = 0.0;
  return true;
}

void ElectronicGear::disengage(const Machine& m) noexcept {
  if (!on_) return;
  on_ = false;
  link_.end();
  if (Axis& f = follower(m); f.follows()) f.stop();
}

/// The follower was lost otherwise where it does not follow any more: what stopped it is an alarm of its own.
bool ElectronicGear::still_led(Axis& f) noexcept {
  Event why{alarm::kGearDisengaged, 0.0, f.setpoint().x};
  if (f.follows() && f.feed_enabled()) return true;
  const bool powerless = !f.geared() || f.letting_go() || !f.power_permitted();
  const GearEnd cause = f.follows() ? GearEnd::feed : powerless ? GearEnd::power : GearEnd::alarm;
  why.detail1 = static_cast<double>(cause);
  end(f, why);
  return false;
}

void ElectronicGear::end(Axis& f, Event why) noexcept {
  why.detail2 = config_.master_axis >= 0 ? config_.master_axis : -1 - config_.master_spindle;
  events_.add(why);
  on_ = false;
  link_.end();
  if (f.follows()) f.stop();
}

/// False: there is none, the master is lost.
bool ElectronicGear::find_target(const Machine& m, image::Nanoseconds acts_ns, image::Nanoseconds period_ns,
                                 GearTarget& out) noexcept {
  out.placed = link_.placed();
  if (!master_known()) return false;
  if (rests_) {
    if (!out.placed) rest_place_ = unit_ * link_.place(measured_turns_);
    out.now = out.next = {rest_place_, 0.0, 0.0};
    return true;
  }
  if (config_.by == CouplingBy::measured) {
    const path::MasterState s = link_.estimate().at(acts_ns - period_ns);
    out.now = led_to(s.n, s.w, s.a);
    return true;
  }
  if (const Spindle* leader = leading_spindle(m); leader != nullptr) {
    const std::optional<path::MasterState> s = leader->commanded(acts_ns);
    if (!s) return false;
    out.next = led_to(s->n, s->w, s->a);
  } else {
    const Axis& a = m.axes[static_cast<std::size_t>(config_.master_axis)];
    if (!a.motion_permitted()) return false;
    const MotionState& s = a.setpoint();
    out.next = led_to(s.x / master_unit_, s.v / master_unit_, s.a / master_unit_);
    out.exact = true;  // a spindle's changes its acceleration at once, which an axis does not
  }
  const double dt = static_cast<double>(period_ns) * 1e-9;
  out.now = {out.next.x - dt * (out.next.v - 0.5 * dt * out.next.a), out.next.v - dt * out.next.a,
             out.next.a};
  return true;
}

/// At the speed only: until then any place would be wrong by the time that is ramped.
void ElectronicGear::take_place(const Axis& f, GearTarget& target) noexcept {
  if (target.placed || std::abs(f.setpoint().v - target.now.v) > GearLaw::at_speed(f.config().limits)) return;
  const double before = link_.place(0.0);
  const double behind = (target.now.x - f.setpoint().x) / unit_;
  if (config_.phase)
    link_.choose(behind);
  else
    link_.capture(behind);
  const double shift = unit_ * (link_.place(0.0) - before);
  target.now.x += shift;
  target.next.x += shift;
  target.placed = true;
}

void ElectronicGear::step(const Machine& m, const image::CycleTime& now) noexcept {
  if (!on_) return;
  Axis& f = follower(m);
  if (!still_led(f)) return;
  const MotionLimits& limits = f.config().limits;
  const image::Nanoseconds acts = now.t_ns + (f.config().feedback_delay - 1) * now.period_ns;
  GearTarget target;
  if (!find_target(m, acts, now.period_ns, target))
    return end(f, {alarm::kGearMasterLost, 0.0, f.setpoint().x});
  const double asked = std::abs(target.now.v);
  if (asked > kSpeedSlack * limits.velocity) return end(f, {alarm::kGearTooFast, limits.velocity, asked});
  take_place(f, target);
  rest_place_ = target.now.x;
  f.set_geared(law_.step(f.setpoint(), target, limits, now.period_s()));
  watch(f, asked, now.period_s());
}

void ElectronicGear::watch(Axis& f, double asked, double dt) noexcept {
  const double behind = link_.placed() ? link_.place(measured_turns_) - f.actual() / unit_ : 0.0;
  phase_error_ = unit_ * behind;
  if (link_.placed() && link_.watch(behind, kTurn * config_.window / unit_, dt))
    return end(f, {alarm::kGearWindow, config_.window, std::abs(phase_error_)});
  const MotionLimits& limits = f.config().limits;
  const double ramps = 2.0 * (asked / limits.acceleration + limits.acceleration / limits.jerk);
  apart_s_ = link_.synchronous() ? 0.0 : apart_s_ + dt;
  if (apart_s_ > kPatience + ramps) end(f, {alarm::kGearNotInStep, config_.window, std::abs(phase_error_)});
}

}  // namespace servogate::axis
