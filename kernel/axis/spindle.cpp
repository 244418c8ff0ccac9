// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/spindle.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/put_bit.hpp"

namespace servogate::axis {

using image::DriveState;
using image::Reaction;

namespace {

constexpr double kSpeedFilter = 0.01;             // s
constexpr double kPowerAfterStop = 1.0;           // s
constexpr double kReadyPatience = 2.0;            // s
constexpr std::uint16_t kTargetReached = 0x0400;  // CiA 402-2, statusword bit 10

/// Angle difference in -180 ... 180 degrees.
double wrapped(double degrees) noexcept { return degrees - 360.0 * std::round(degrees / 360.0); }

}  // namespace

void Spindle::configure(const SpindleConfig& config, int index) {
  *this = Spindle{};
  config_ = config;
  limit_rpm_ = config.max_rpm;
  index_ = index;
  scale_ = {config.counts_numerator, config.counts_denominator, config.count_direction, 0, 0.0};
  if (config.inverter) inverter_.configure(*config.inverter);
  gears_.configure(config.gearbox);
}

void Spindle::order(SpindleMode mode, double rpm) noexcept {
  if (link_.on() && mode != SpindleMode::stop) {
    cannot_ = alarm::kSpindleCoupled;
    return;
  }
  parting_ = link_.synchronous() || (parting_ && mode == SpindleMode::stop);
  link_.end();
  const bool analog = config_.inverter.has_value();
  if (lent() && mode != SpindleMode::stop) {
    cannot_ = alarm::kSpindleIsAxis;
    return;
  }
  orient_deg_ = config_.orient_angle;
  const bool no_angle = mode == SpindleMode::orient && (analog || !config_.encoder);
  const bool no_relay = mode == SpindleMode::ccw && (analog ? !inverter_.reverses() : !config_.reverses);
  if (no_angle) cannot_ = alarm::kSpindleNoEncoder;
  if (no_relay) cannot_ = alarm::kSpindleNoReverse;
  mode_ = no_angle || no_relay ? SpindleMode::stop : mode;
  adjust(rpm);
  if (mode_ != SpindleMode::stop && (ordered_rpm_ > 0.0 || gear_wish_ > 0)) {
    gears_.choose(ordered_rpm_, gear_wish_);
    raised_gear_ = false;
  }
  wait_s_ = 0.0;
  orienting_ = oriented_ = at_speed_ = false;
  raised_speed_ = raised_orient_ = false;
}

void Spindle::turn(double degrees, double rpm) noexcept {
  if (link_.on() || lent()) {
    cannot_ = lent() ? alarm::kSpindleIsAxis : alarm::kSpindleCoupled;
    return;
  }
  const bool measures = !config_.inverter && config_.encoder;
  if (!measures || !angle_known_ || !std::isfinite(degrees)) {
    order(SpindleMode::stop, 0.0);
    cannot_ = measures ? alarm::kSpindleOrientTimeout : alarm::kSpindleNoEncoder;
    return;
  }
  const bool held = mode_ == SpindleMode::orient || mode_ == SpindleMode::turn;
  const double from = total_turns() + (held ? angle_error() / 360.0 : 0.0);
  mode_ = SpindleMode::turn;
  adjust(rpm);
  goal_turns_ = from + degrees / 360.0;
  turn_s_ = ordered_rpm_ > 0.0 ? std::abs(degrees) / (6.0 * ordered_rpm_) : 0.0;
  wait_s_ = 0.0;
  orienting_ = oriented_ = at_speed_ = false;
  raised_speed_ = raised_orient_ = false;
}

void Spindle::adjust(double rpm) noexcept {
  const double wish = std::isfinite(rpm) ? std::abs(rpm) : 0.0;
  ordered_rpm_ = wish > 0.0 ? std::clamp(wish, config_.min_rpm, config_.max_rpm) : 0.0;
}

void Spindle::read(image::ProcessImage& image) noexcept {
  events_.clear();
  using image::field;
  using image::kSpindleFields;
  const std::uint32_t base = image::spindle_base(index_);
  power_on_ = image.packets.bit(field(image::kMachineFields, "power_on", image::kMachineBase));
  enable_ = power_on_ && image.packets.bit(image::at(field(kSpindleFields, "enable"), base));
  const double percent = image.packets.number(image::at(field(kSpindleFields, "override"), base));
  const double limit = image.packets.number(image::at(field(kSpindleFields, "limit"), base));
  limit_rpm_ = limit > 0.0 ? std::min(limit, config_.max_rpm) : config_.max_rpm;
  override_ratio_ = percent > 0.0 ? std::clamp(percent, 50.0, 125.0) / 100.0 : 1.0;

  const auto wish =
      static_cast<int>(image.packets.number(image::at(field(kSpindleFields, "gear_wish"), base)));
  if (wish != gear_wish_ && wish > 0) {
    gears_.choose(ordered_rpm_, wish);
    raised_gear_ = false;
  }
  gear_wish_ = wish;

  const double dt = image.now.period_s();
  image::SpindleImage& shared = image.spindles[static_cast<std::size_t>(index_)];
  if (config_.inverter) {
    lost_ = inverter_.lost(image) || gears_.lost(image);
    shared.actual_rpm = actual_rpm_;
    return;
  }
  watch_source(image);
  const image::DriveFeedback& in = shared.drive;
  if (in.online && drive_.online) {
    // A drive that supplies only one of speed and position leaves the other one standing still.
    const double counts_s = in.velocity_counts_s != 0.0
                                ? in.velocity_counts_s
                                : static_cast<double>(in.position_counts - drive_.position_counts) / dt;
    const double turns_s = scale_.velocity(counts_s) / gears_.ratio();
    actual_rpm_ += (turns_s * 60.0 - actual_rpm_) * std::min(1.0, dt / kSpeedFilter);
    if (in.latch_sequence != drive_.latch_sequence && !marked_) {
      scale_.reference_counts = in.latch_counts;
      marked_ = true;
    }
  }
  drive_ = in;
  if (!in.online) {
    actual_rpm_ = 0.0;
    // An angle that is counted from a zero that is gone is no goal any more: nothing turns again unasked.
    if (mode_ == SpindleMode::turn || link_.on()) {
      const bool turns = mode_ == SpindleMode::turn;
      if (turns)
        order(SpindleMode::stop, 0.0);
      else
        part_from_leader();
      if (turns) cannot_ = alarm::kSpindleOrientTimeout;
    }
    marked_ = began_ = angle_known_ = false;
    master_.valid = false;
    return;
  }
  read_angle(in, image.now);
  shared.actual_rpm = actual_rpm_;
  shared.angle_deg = angle_deg_;
}

/// Whole turns are counted as integers: the angle stays exact however long the spindle runs.
void Spindle::read_angle(const image::DriveFeedback& in, const image::CycleTime& now) noexcept {
  constexpr std::int64_t kWithoutMark = 3;  // revolutions after which a drive is known to tell none
  const std::int64_t span = config_.counts_numerator;
  if (!began_) first_counts_ = in.position_counts;
  began_ = true;
  const std::int64_t gone = std::abs(in.position_counts - first_counts_) * config_.counts_denominator;
  if (!angle_known_ && (marked_ || gone > kWithoutMark * span)) {
    angle_known_ = true;
    angle_zero_ = marked_ ? scale_.reference_counts : first_counts_;
  }
  const std::int64_t zero = angle_known_ ? angle_zero_ : scale_.reference_counts;
  const std::int64_t counts = (in.position_counts - zero) * scale_.direction * config_.counts_denominator;
  const std::int64_t whole = counts / span - (counts % span < 0 ? 1 : 0);
  master_.turns = whole;
  master_.part = static_cast<double>(counts - whole * span) / static_cast<double>(span);
  master_.valid = config_.encoder && angle_known_;
  const double own = static_cast<double>(((in.position_counts - scale_.reference_counts) % span) *
                                         scale_.direction * config_.counts_denominator) /
                     static_cast<double>(span);
  angle_deg_ = 360.0 * (own - std::floor(own));
  if (in.missed == 0)
    master_.at_ns = now.t_ns - now.period_ns - static_cast<image::Nanoseconds>(config_.encoder_delay * 1e9);
}

void Spindle::watch_source(const image::ProcessImage& image) noexcept {
  if (config_.source < 0) return;
  if (drive_.online) turned_ = std::abs(actual_rpm_) > config_.zero_speed_rpm;
  seen_lost_ = lost_;
  lost_ = image.sources[static_cast<std::size_t>(config_.source)].quality >= image::Quality::stale;
}

/// A drive that is gone or has tripped: nothing turns again unasked, neither by its acknowledgement nor when
/// it is back.
void Spindle::give_up() noexcept {
  if (lost_ && !seen_lost_ && config_.source >= 0) events_.add({alarm::kSpindleDriveLost, ordered_rpm_, 0.0});
  const bool fault = drive_.state == DriveState::fault || drive_.state == DriveState::fault_reaction_active;
  const bool gone = config_.source >= 0 ? lost_ : std::exchange(was_online_, drive_.online) && !drive_.online;
  if ((gone || (drive_.online && fault)) && mode_ != SpindleMode::stop && !config_.inverter)
    order(SpindleMode::stop, 0.0);
}

/// From where the spindle stands to where it is to stand, degrees: the nearer way round, or all of a turn.
double Spindle::angle_error() const noexcept {
  if (mode_ == SpindleMode::turn) return 360.0 * (goal_turns_ - total_turns());
  return wrapped(orient_deg_ - angle_deg_);
}

/// Speed of the position loop that leads to an angle.
double Spindle::held_rpm(double error, double most_rpm) noexcept {
  const double braking = std::sqrt(2.0 * config_.acceleration * std::abs(error) / 6.0) * 0.7;
  const double speed = std::min({config_.orient_gain * std::abs(error) / 6.0, braking, most_rpm});
  oriented_ = std::abs(error) <= config_.orient_window && std::abs(actual_rpm_) <= config_.zero_speed_rpm;
  return std::copysign(speed, error);
}

/// Signed speed of the order with its override, whatever the PLC permits.
double Spindle::ordered_speed() const noexcept {
  if ((mode_ != SpindleMode::cw && mode_ != SpindleMode::ccw) || ordered_rpm_ == 0.0) return 0.0;
  const double most = std::min(fastest(), leading_.rpm);
  const double rpm = std::clamp(ordered_rpm_ * override_ratio_, std::min(config_.min_rpm, most), most);
  return mode_ == SpindleMode::cw ? rpm : -rpm;
}

double Spindle::wanted_rpm() noexcept {
  if (!enable_ || reaction_ >= Reaction::stop_and_power_off) return 0.0;
  switch (mode_) {
    case SpindleMode::stop:
      return 0.0;
    case SpindleMode::cw:
    case SpindleMode::ccw:
      if (!gears_.changing()) return ordered_speed();
      return std::copysign(std::min(gears_.config().change_rpm, ordered_rpm_), ordered_speed());
    case SpindleMode::turn:
      return held_rpm(angle_error(), std::min(ordered_rpm_, gears_.max_rpm(config_.max_rpm)));
    case SpindleMode::follow:
      return std::clamp(led_.rpm, -fastest(), fastest());
    case SpindleMode::orient:
      break;
  }
  orienting_ = orienting_ || (marked_ && std::abs(command_rpm_) <= config_.orient_rpm);
  return orienting_ ? held_rpm(angle_error(), config_.orient_rpm)
                    : std::copysign(config_.orient_rpm, command_rpm_);
}

void Spindle::follow_drive(double wanted, double dt) noexcept {
  const bool enabled = drive_.online && drive_.state == DriveState::operation_enabled && !lent();
  const bool was_on = std::exchange(on_, enabled);
  if (link_.on() && was_on && !on_) {
    // It would chase what it has lost as soon as its drive is acknowledged.
    const bool turns = std::max(std::abs(command_rpm_), std::abs(actual_rpm_)) > config_.zero_speed_rpm;
    turns ? part_from_leader() : link_.lose_place();
  }
  const double step = ramp_rpm_s(wanted) * dt;
  command_rpm_ = on_ ? command_rpm_ + std::clamp(wanted - command_rpm_, -step, step) : actual_rpm_;
  if (command_rpm_ == 0.0 || !on_ || urgent()) parting_ = false;
  hold_to_angle(dt);
}

void Spindle::follow_inverter(image::ProcessImage& image, double& wanted, double dt) noexcept {
  on_ = power_on_ && !lost_ && reaction_ < Reaction::stop_and_power_off;
  if (!on_ && mode_ != SpindleMode::stop) {
    if (lost_) events_.add({alarm::kSpindleOutputLost, ordered_rpm_, command_rpm_});
    order(SpindleMode::stop, 0.0);
    wanted = 0.0;
  }
  inverter_.advance(wanted, config_.acceleration * dt, !on_, dt);
  inverter_.write(image, gears_.ratio());
  command_rpm_ = inverter_.command_rpm();
  actual_rpm_ = inverter_.assumed_rpm();
}

/// Only while the spindle is known to turn slowly, and with the power that is there to see it.
void Spindle::change_gear(image::ProcessImage& image, double dt) noexcept {
  if (!gears_.present()) return;
  const bool was_lost = std::exchange(gear_lost_, gears_.lost(image));
  const double slowly = std::max(gears_.config().change_rpm * 1.05, config_.zero_speed_rpm);
  const bool known = config_.inverter ? !lost_ : drive_.online;
  const bool slow = power_on_ && known && std::abs(actual_rpm_) <= slowly && std::abs(command_rpm_) <= slowly;
  gears_.step(image, slow, gear_lost_, dt);
  const bool turns = mode_ == SpindleMode::cw || mode_ == SpindleMode::ccw;
  if (gears_.failed() && !raised_gear_) {
    raised_gear_ = true;
    events_.add({alarm::kSpindleGear, static_cast<double>(gears_.wanted()), actual_rpm_});
    order(SpindleMode::stop, 0.0);
  }
  if (gear_lost_ && !config_.inverter && turns) {
    if (!was_lost) events_.add({alarm::kSpindleOutputLost, ordered_rpm_, command_rpm_});
    order(SpindleMode::stop, 0.0);
  }
}

void Spindle::command(image::ProcessImage& image) noexcept {
  const double dt = image.now.period_s();
  if (cannot_ != 0) events_.add({cannot_, 0.0, 0.0});
  give_up();
  change_gear(image, dt);
  if (reaction_ >= Reaction::stop_and_power_off) order(SpindleMode::stop, 0.0);
  cannot_ = 0;
  oriented_ = false;
  watch_coupling(dt);
  double wanted = std::clamp(wanted_rpm(), -limit_rpm_, limit_rpm_);
  if (config_.inverter)
    follow_inverter(image, wanted, dt);
  else
    follow_drive(wanted, dt);
  track_command(image.now);
  const bool reached = on_ && command_rpm_ == wanted;
  const bool known = config_.source < 0 || drive_.online || !turned_;
  zero_speed_ = known && std::abs(actual_rpm_) <= config_.zero_speed_rpm;
  const bool turning = mode_ == SpindleMode::cw || mode_ == SpindleMode::ccw;
  // Of a speed of 0 no share can be kept: it is at speed when it stands.
  const double window = wanted != 0.0 ? config_.at_speed_window * std::abs(wanted) : config_.zero_speed_rpm;
  const bool told = !config_.target_bit || wanted == 0.0 || (drive_.statusword & kTargetReached) != 0;
  const bool in_gear = !gears_.changing();
  at_speed_ = turning && enable_ && in_gear && reached && told && std::abs(actual_rpm_ - wanted) <= window;
  if (mode_ == SpindleMode::follow) at_speed_ = synchronous();
  supervise(dt, enable_ && in_gear && reached && ordered_speed() != 0.0);

  off_s_ = mode_ == SpindleMode::stop && zero_speed_ ? off_s_ + dt : 0.0;
  note_rest();
  image::SpindleImage& out = image.spindles[static_cast<std::size_t>(index_)];
  out.command_rpm = on_ ? command_rpm_ : 0.0;
  out.running = mode_ != SpindleMode::stop || !zero_speed_;
  out.at_speed = at_speed_;
  out.is_axis = lent();
  out.coupled = link_.placed() && led_.known;
  out.phase_error_deg = out.coupled ? phase_error_deg_ : 0.0;
  leading_ = {};
  if (!config_.inverter) write_drive(image, out);
  write_interface(image);
}

void Spindle::write_drive(image::ProcessImage& image, image::SpindleImage& out) const noexcept {
  if (lent()) return pass_on(image);
  // A drive in its quick stop brakes, too: without power it would coast.
  const bool holds = on_ || (drive_.online && drive_.state == DriveState::quick_stop_active);
  const bool needed =
      mode_ != SpindleMode::stop ? enable_ || !zero_speed_ : off_s_ < kPowerAfterStop && holds;
  image::DriveCommand& drive = out.drive_command;
  drive.power = needed && reaction_ < Reaction::power_off && use_ != Use::freeing;
  drive.brake_release = false;
  drive.quick_stop = reaction_ == Reaction::quick_stop;
  drive.reset_fault = reset_pending_;
  drive.mode = image::DriveMode::csv;
  drive.latch_source = image::LatchSource::zero_mark;
  drive.latch_arm = !marked_ && drive_.online;
  drive.latch_negative = false;
  drive.position_counts = drive_.position_counts;
  drive.velocity_counts_s =
      on_ ? scale_.velocity_counts((command_rpm_ + correction_rpm_) / 60.0) * gears_.ratio() : 0.0;
}

void Spindle::pass_on(image::ProcessImage& image) const noexcept {
  if (!lent()) return;
  image::DriveCommand& drive = image.spindles[static_cast<std::size_t>(index_)].drive_command;
  drive = image.axes[static_cast<std::size_t>(config_.axis)].drive_command;
  drive.reset_fault = drive.reset_fault || reset_pending_;
}

void Spindle::supervise(double dt, bool speed_due) noexcept {
  const bool fault = drive_.state == DriveState::fault || drive_.state == DriveState::fault_reaction_active;
  reset_left_s_ -= dt;
  if (!fault || reset_left_s_ <= 0.0) reset_pending_ = false;
  if (fault && lent()) raised_fault_ = true;  // the axis says it
  if (fault && !reset_pending_ && drive_.online && !raised_fault_) {
    raised_fault_ = true;
    events_.add({alarm::kSpindleDriveFault, 0.0, static_cast<double>(drive_.error_code)});
  }
  const bool refuses = config_.source >= 0 && mode_ != SpindleMode::stop && enable_ && drive_.online &&
                       drive_.state == DriveState::switch_on_disabled;
  not_ready_s_ = refuses ? not_ready_s_ + dt : 0.0;
  if (not_ready_s_ > kReadyPatience && !raised_ready_) {
    raised_ready_ = true;
    events_.add({alarm::kSpindleNotReady, 0.0, static_cast<double>(drive_.error_code)});
  }
  const bool held = mode_ == SpindleMode::orient || mode_ == SpindleMode::turn;
  const bool orient_due = held && enable_ && !oriented_;
  const double patience = config_.orient_timeout + (mode_ == SpindleMode::turn ? turn_s_ : 0.0);
  wait_s_ = (speed_due && !at_speed_) || orient_due ? wait_s_ + dt : 0.0;
  if (speed_due && config_.at_speed_timeout > 0.0 && wait_s_ > config_.at_speed_timeout && !raised_speed_) {
    raised_speed_ = true;
    events_.add({alarm::kSpindleNotAtSpeed, ordered_speed(), actual_rpm_});
  }
  if (orient_due && config_.orient_timeout > 0.0 && wait_s_ > patience && !raised_orient_) {
    raised_orient_ = true;
    const double wanted = orient_deg_;
    events_.add({alarm::kSpindleOrientTimeout,
                 mode_ == SpindleMode::turn ? 360.0 * (goal_turns_ - std::floor(goal_turns_)) : wanted,
                 angle_deg_});
  }
}

void Spindle::write_interface(image::ProcessImage& image) const noexcept {
  using image::field;
  using image::kSpindleFields;
  const std::uint32_t base = image::spindle_base(index_);
  auto put = [&](const image::Place& p, bool value) __attribute__((always_inline)) {
    image::put_bit(image.packets, image::at(p, base), value);
  };
  put(field(kSpindleFields, "run"), mode_ != SpindleMode::stop);
  put(field(kSpindleFields, "cw"), mode_ == SpindleMode::cw);
  put(field(kSpindleFields, "ccw"), mode_ == SpindleMode::ccw);
  put(field(kSpindleFields, "orient"), mode_ == SpindleMode::orient || mode_ == SpindleMode::turn);
  put(field(kSpindleFields, "at_speed"), at_speed_);
  put(field(kSpindleFields, "zero_speed"), zero_speed_);
  put(field(kSpindleFields, "oriented"), oriented_);
  image.packets.set_number(image::at(field(kSpindleFields, "command"), base),
                           image.spindles[static_cast<std::size_t>(index_)].command_rpm);
  image.packets.set_number(image::at(field(kSpindleFields, "actual"), base), actual_rpm_);
  if (gears_.present())
    image.packets.set_number(image::at(field(kSpindleFields, "gear"), base),
                             gears_.changing() ? 0 : gears_.engaged());
}

bool Spindle::settled() const noexcept {
  switch (mode_) {
    case SpindleMode::stop:
      return zero_speed_;
    case SpindleMode::orient:
    case SpindleMode::turn:
      return oriented_;
    case SpindleMode::follow:
      return synchronous();
    default:
      return at_speed_;
  }
}

bool Spindle::present(image::AlarmNumber number) const noexcept {
  const bool fault = drive_.state == DriveState::fault || drive_.state == DriveState::fault_reaction_active;
  if (number == alarm::kSpindleDriveLost) return lost_ && !config_.inverter;
  return number == alarm::kSpindleDriveFault && drive_.online && fault && !reset_pending_;
}

void Spindle::reset() noexcept {
  raised_fault_ = raised_speed_ = raised_orient_ = raised_ready_ = false;
  wait_s_ = 0.0;
  reset_pending_ = drive_.state == DriveState::fault;
  reset_left_s_ = 1.0;
}

}  // namespace servogate::axis
