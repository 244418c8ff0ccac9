// SPDX-License-Identifier: Apache-2.0
// A spindle among others: the one that leads, and the one that follows its angle.
#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/axis/spindle.hpp"

namespace servogate::axis {
namespace {

constexpr double kRoomToCatchUp = 0.98;  // of the follower's fastest speed, for the leader
constexpr double kRampOf = 0.8;          // of the follower's ramp, for the leader
constexpr double kBrakesOf = 0.7;        // of its ramp, with which the position loop brakes
/// 1/s, of the position loop: with the lag of a drive it leaves acceleration x lag / gain while speeds
/// change.
constexpr double kGain = 20.0;
constexpr double kRests = 0.5;    // s at standstill; the drive has its power for longer
constexpr double kMostOff = 0.5;  // turns that are caught up; further off the nearest place is a new one

}  // namespace

double Spindle::fastest() const noexcept { return std::min(gears_.max_rpm(config_.max_rpm), limit_rpm_); }

/// What it is to come down for does not wait for the other spindle.
bool Spindle::urgent() const noexcept {
  return reaction_ >= image::Reaction::stop_and_power_off || !enable_ || std::abs(command_rpm_) > limit_rpm_;
}

/// That of a follower binds where both go together: in step, or on the way up to it.
double Spindle::ramp_rpm_s(double wanted) const noexcept {
  constexpr double kRounding = 1.0 + 1e-9;
  if (urgent()) return config_.acceleration;
  const bool slows = std::abs(wanted) < std::abs(command_rpm_) || wanted * command_rpm_ < 0.0;
  const bool together = leading_.in_step ? std::abs(command_rpm_) <= leading_.rpm * kRounding : !slows;
  const double own = together ? std::min(config_.acceleration, leading_.rpm_s) : config_.acceleration;
  return parting_ ? std::min(own, led_rpm_s_) : own;
}

void Spindle::couple(const CouplingOrder& order) noexcept {
  if (lent()) {
    cannot_ = alarm::kSpindleIsAxis;
    return;
  }
  link_.begin(order);
  mode_ = SpindleMode::follow;
  ordered_rpm_ = 0.0;
  led_ = {};
  led_rpm_s_ = config_.acceleration;
  apart_s_ = 0.0;
  parting_ = orienting_ = oriented_ = at_speed_ = raised_speed_ = raised_orient_ = false;
}

void Spindle::uncouple() noexcept {
  if (link_.on()) order(SpindleMode::stop, 0.0);
}

/// By an alarm: it has lost what it follows with, or what it follows.
void Spindle::part_from_leader() noexcept {
  events_.add({alarm::kSpindleSyncLost, config_.coupling_window, std::abs(phase_error_deg_)});
  order(SpindleMode::stop, 0.0);
}

/// Without power or enable, or shortly before the power is taken, whoever turns it by hand does not turn a
/// follower.
void Spindle::note_rest() noexcept {
  const bool turning = mode_ == SpindleMode::cw || mode_ == SpindleMode::ccw;
  if (turning && on_ && enable_)
    rests_ = false;
  else if (drive_.online && zero_speed_ && (!on_ || !enable_ || off_s_ >= kRests))
    rests_ = true;
}

void Spindle::lead(const Spindle& follower) noexcept {
  const double ratio = std::abs(follower.link_.ratio());
  lead({follower.config_.coupling == CouplingBy::setpoint, follower.synchronous() || follower.parting_,
        kRampOf * follower.config_.acceleration / ratio, kRoomToCatchUp * follower.fastest() / ratio});
}

void Spindle::lead(const LeadDemand& demand) noexcept {
  leading_.by_setpoint = leading_.by_setpoint || demand.by_setpoint;
  leading_.in_step = leading_.in_step || demand.in_step;
  leading_.rpm_s = std::min(leading_.rpm_s, demand.rpm_s);
  leading_.rpm = std::min(leading_.rpm, demand.rpm);
}

void Spindle::follow(const Spindle& leader, const image::CycleTime& now) noexcept {
  led_ = {};
  if (!link_.on()) return;
  const bool by_setpoint = config_.coupling == CouplingBy::setpoint;
  path::MasterReading reading;
  reading.valid = leader.master_.valid;
  reading.turns = leader.master_.turns;
  reading.part = leader.master_.part;
  reading.at_ns = leader.master_.at_ns;
  reading.acts_ns = now.t_ns + now.period_ns;
  link_.look(reading);
  if (leader.rests_) return link_.lose_place();
  const path::MasterEstimate& measured = link_.estimate();
  led_rpm_s_ =
      std::min(kRampOf * config_.acceleration, std::abs(link_.ratio()) * leader.config_.acceleration);
  led_.rpm = link_.ratio() *
             (by_setpoint || !measured.known() ? leader.command_rpm_ : 60.0 * measured.at(reading.acts_ns).w);
  led_.known =
      master_.valid && leader.master_.valid && (by_setpoint ? leader.track_.begun() : measured.known());
  if (!led_.known) return;
  led_.turns = link_.place(by_setpoint ? leader.track_.at(master_.at_ns) : measured.at(master_.at_ns).n);
  const double later = static_cast<double>(master_.at_ns - leader.master_.at_ns) * 1e-9;
  const double seen = leader.total_turns() + later * leader.actual_rpm_ / 60.0;
  led_.seen = by_setpoint ? link_.place(seen) : led_.turns;
}

/// A follower or the machine file has its commanded angle lead, and it is held to that.
bool Spindle::by_setpoint() const noexcept {
  const bool turns = mode_ == SpindleMode::cw || mode_ == SpindleMode::ccw || mode_ == SpindleMode::stop;
  return leading_.by_setpoint || (config_.thread_by_setpoint && turns);
}

std::optional<double> Spindle::setpoint_ahead() const noexcept {
  if (!config_.thread_by_setpoint || !track_.begun() || !master_.valid) return std::nullopt;
  return track_.at(master_.at_ns) - total_turns();
}

std::optional<path::MasterState> Spindle::commanded(image::Nanoseconds t_ns) const noexcept {
  if (!track_.begun() || !master_.valid) return std::nullopt;
  return path::MasterState{track_.at(t_ns), command_turns_s_, command_turns_s2_};
}

/// From where it was at its newest reading to where it was led to at that time.
double Spindle::behind_turns(bool& led) const noexcept {
  led = enable_ && on_;
  if (led && link_.placed() && led_.known) return led_.turns - total_turns();
  if (led && by_setpoint() && track_.begun() && master_.valid)
    return track_.at(master_.at_ns) - total_turns();
  led = false;
  return 0.0;
}

/// The position loop over the speed that is commanded ahead.
void Spindle::hold_to_angle(double dt) noexcept {
  bool led = false;
  const double behind = behind_turns(led), degrees = 360.0 * std::abs(behind);
  const double braking = std::sqrt(2.0 * config_.acceleration * degrees / 6.0) * kBrakesOf;
  const double speed = std::min({kGain * degrees / 6.0, braking, config_.orient_rpm});
  const double step = config_.acceleration * dt;
  correction_rpm_ += std::clamp((led ? std::copysign(speed, behind) : 0.0) - correction_rpm_, -step, step);
  correction_rpm_ = std::clamp(correction_rpm_, std::min(0.0, -limit_rpm_ - command_rpm_),
                               std::max(0.0, limit_rpm_ - command_rpm_));
  if (!on_) correction_rpm_ = 0.0;
}

/// What is commanded in this cycle turns the drive from the next SYNC to the one behind it.
void Spindle::track_command(const image::CycleTime& now) noexcept {
  if (!by_setpoint() || !on_ || !master_.valid) return track_.forget();
  // Without its enable, or under a load that it does not bear: what is lost is not caught up.
  if (!leading_.by_setpoint && track_.begun() &&
      std::abs(track_.at(master_.at_ns) - total_turns()) > kMostOff)
    track_.forget();
  const image::Nanoseconds acts = now.t_ns + now.period_ns;
  const double dt = now.period_s();
  if (!track_.begun()) {
    const double since = static_cast<double>(acts - master_.at_ns) * 1e-9;
    track_.put(total_turns() + since * actual_rpm_ / 60.0, acts);
    last_rpm_ = command_rpm_;
  }
  track_.put(track_.newest() + command_rpm_ / 60.0 * dt, acts + now.period_ns);
  // Where the place of this cycle is, one speed goes over into the next.
  command_turns_s2_ = (command_rpm_ - last_rpm_) / 60.0 / dt;
  command_turns_s_ = 0.5 * (command_rpm_ + std::exchange(last_rpm_, command_rpm_)) / 60.0;
}

/// Before the set-point of the cycle.
void Spindle::watch_coupling(double dt) noexcept {
  if (!link_.on()) return;
  const bool turns =
      std::abs(led_.rpm) > config_.zero_speed_rpm || std::abs(actual_rpm_) > config_.zero_speed_rpm;
  if (link_.placed() && !led_.known) {
    if (turns) return part_from_leader();
    link_.lose_place();
  }
  if (link_.placed() && !enable_) {
    if (link_.synchronous() && turns)
      events_.add({alarm::kSpindleSyncLost, config_.coupling_window, std::abs(phase_error_deg_)});
    link_.lose_place();
  }
  const double behind = led_.known ? led_.seen - total_turns() : 0.0;
  phase_error_deg_ = 360.0 * behind;
  // The place is chosen at the speed: until then any would be wrong by the time that is ramped.
  if (!link_.placed() && led_.known && turns && on_ && enable_ &&
      std::abs(command_rpm_ - led_.rpm) <= config_.acceleration * dt) {
    const double before = link_.place(0.0);
    link_.choose(behind);
    phase_error_deg_ += 360.0 * (link_.place(0.0) - before);
  } else if (link_.placed() && link_.watch(behind, config_.coupling_window, dt)) {
    events_.add({alarm::kSpindleSyncLost, config_.coupling_window, 360.0 * std::abs(behind)});
  } else if (link_.placed() && !link_.synchronous() && std::abs(behind) > kMostOff) {
    link_.lose_place();
  }
  const double ramp = std::abs(led_.rpm) / config_.acceleration;
  apart_s_ = turns && enable_ && !link_.synchronous() ? apart_s_ + dt : 0.0;
  if (config_.at_speed_timeout > 0.0 && apart_s_ > config_.at_speed_timeout + 2.0 * ramp && !raised_speed_) {
    raised_speed_ = true;
    events_.add({alarm::kSpindleNotSynchronous, config_.coupling_window, 360.0 * std::abs(behind)});
  }
}

void command_all(std::span<Spindle> spindles, image::Reaction reaction, image::ProcessImage& image) noexcept {
  const auto leader_of = [&](const Spindle& follower) -> Spindle& {
    return *std::find_if(spindles.begin(), spindles.end(),
                         [&](const Spindle& s) { return s.config().process == follower.config().process; });
  };
  for (const Spindle& s : spindles)
    if (s.has_leader()) leader_of(s).lead(s);
  for (Spindle& s : spindles) s.react(reaction);
  for (Spindle& s : spindles)
    if (!s.coupled()) s.command(image);
  for (Spindle& s : spindles) {
    if (!s.coupled()) continue;
    s.follow(leader_of(s), image.now);
    s.command(image);
  }
}

}  // namespace servogate::axis
