// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/axis/axis.hpp"

namespace servogate::axis {

using image::DriveState;

namespace {

constexpr double kVelocityFilter = 0.01;  // s
/// A way so many times as long as at the greatest speed is a jump: a cycle may be two periods late untold.
constexpr double kJumpRatio = 3.0;
/// Where process data may be missing for ever, so many in a row still mean nothing.
constexpr std::uint32_t kMissedUnjudged = 3;
constexpr double kOffPathRest = 0.1;  // s

bool on(const image::ProcessImage& image, const std::optional<SwitchPlace>& s) noexcept {
  return s && image.packets.bit(s->place) != s->inverted;
}

constexpr double kBounce_s = 0.1;  ///< a switch that was free for less is one that bounces

}  // namespace

const Axis::Sent& Axis::sent(int cycles_ago) const noexcept {
  return history_[static_cast<std::size_t>((head_ + kHistory + 1 - std::clamp(cycles_ago, 1, kHistory)) %
                                           kHistory)];
}

void Axis::raise(image::AlarmNumber number, double limit, double value, double d1, double d2) noexcept {
  for (int i = 0; i < raised_count_; ++i)
    if (raised_[static_cast<std::size_t>(i)] == number) return;
  if (raised_count_ < std::ssize(raised_)) raised_[static_cast<std::size_t>(raised_count_++)] = number;
  events_.add({number, limit, value, d1, d2});
}

/// Whether a switch came on that had been free for longer than contacts bounce.
bool Axis::met(bool on, double& free_s, double dt) noexcept {
  const bool came = on && free_s > kBounce_s;
  free_s = on ? 0.0 : free_s + dt;
  return came;
}

void Axis::read_places(const image::ProcessImage& image) noexcept {
  using image::field;
  using image::kAxisFields;
  const std::uint32_t base = image::axis_base(index_);
  auto bit = [&](const image::Place& p) __attribute__((always_inline)) {
    return image.packets.bit(image::at(p, base));  // a few instructions where the place is known
  };
  limit_plus_ = on(image, config_.limit_plus) || bit(field(kAxisFields, "limit_plus"));
  limit_minus_ = on(image, config_.limit_minus) || bit(field(kAxisFields, "limit_minus"));
  met_plus_ = met(limit_plus_, plus_free_s_, image.now.period_s());
  met_minus_ = met(limit_minus_, minus_free_s_, image.now.period_s());
  home_switch_ = on(image, config_.home_switch) || bit(field(kAxisFields, "home_switch"));
  feed_enable_ = bit(field(kAxisFields, "feed_enable"));
  power_permitted_ = bit(field(kAxisFields, "enable")) &&
                     image.packets.bit(field(image::kMachineFields, "power_on", image::kMachineBase));
  plc_jog_ = static_cast<int>(bit(field(kAxisFields, "jog_plus"))) -
             static_cast<int>(bit(field(kAxisFields, "jog_minus")));
}

/// A position that is read in this cycle was latched at the begin of the last one.
void Axis::read_edges(const image::ProcessImage& image) noexcept {
  now_ns_ = image.now.t_ns;
  if (!config_.homing.edges || !homing_.active() || !config_.home_switch) return;
  if (drive_.online && drive_.missed == 0)
    homing_.sample(now_ns_ - image.now.period_ns, drive_.position_counts);
  for (const image::Edge& e : image.edges.list())
    if (e.place == config_.home_switch->place)
      homing_.switch_edge(e.level != config_.home_switch->inverted, e.t_ns);
}

void Axis::read_feedback(const image::DriveFeedback& in, double dt) noexcept {
  const std::int64_t before = last_counts_;
  drive_ = in;
  reset_left_s_ -= dt;
  const bool faulty = in.state == DriveState::fault || in.state == DriveState::fault_reaction_active;
  if (!faulty || reset_left_s_ <= 0.0) reset_pending_ = false;
  if (!in.online) {
    drive_.position_counts = before;  // what stands in it is not fresh
    following_error_ = 0.0;
    return;
  }
  // What has not come is not judged: the axis neither stands nor falls behind because a frame is missing. How
  // many may be missing is supervised by itself.
  if (seen_counts_ && in.missed > 0 && in.missed <= std::max(config_.missed_limit, kMissedUnjudged)) {
    last_missed_ = in.missed;
    return;
  }
  last_counts_ = in.position_counts;
  motor_ = scale_.position(in.position_counts);
  if (seen_counts_) {
    double step = scale_.velocity(static_cast<double>(in.position_counts - before));
    const double since = dt * (1.0 + last_missed_) + late_s_;
    const double permitted = kJumpRatio * config_.limits.velocity * since + 20.0 / scale_.per_unit();
    if (std::abs(step) > permitted && homing_.drive_leads()) {
      step = actual_velocity_ * dt;  // the drive counts from its new zero
    } else if (std::abs(step) > permitted) {
      raise(alarm::kEncoderJump, permitted, step);
      drop_reference();
    }
    const double span = in.missed == 0 ? since : dt;
    actual_velocity_ += (step / span - actual_velocity_) * std::min(1.0, span / kVelocityFilter);
  }
  seen_counts_ = true;
  late_s_ = 0.0;
  last_missed_ = in.missed;
  actual_standing_ = std::abs(actual_velocity_) <= config_.standstill_velocity;
  const Sent& then = sent(config_.feedback_delay);
  actual_ = motor_ - then.compensation;
  following_error_ = held_ && !homing_.drive_leads() && !torque_.leads() ? then.command - actual_ : 0.0;
  const double speed = std::abs(then.command - sent(config_.feedback_delay + 1).command) / dt;
  following_limit_ = config_.following_error_limit + config_.following_error_velocity * speed;
  following_warn_ = config_.following_error_warn + config_.following_error_velocity * speed;
}

void Axis::supervise_drive() noexcept {
  if (!drive_.online) {
    if (seen_online_) {
      raise(alarm::kDriveOffline, 0.0, actual_, actual_velocity_);
      drop_reference();
      seen_counts_ = false;
    }
    seen_online_ = false;
    return;
  }
  seen_online_ = true;
  if (drive_.state == DriveState::fault || drive_.state == DriveState::fault_reaction_active) {
    if (!reset_pending_) raise(alarm::kDriveFault, 0.0, drive_.error_code);
  } else if (drive_.refusal.waited_ms > 0) {
    // Enable operation is held back until the drive shows its mode: then it is 6061h that is waited for.
    const bool mode_awaited = drive_.refusal.wanted == DriveState::operation_enabled &&
                              drive_.refusal.from == DriveState::switched_on &&
                              drive_.mode != image::DriveMode::csp;
    raise(alarm::kDriveRefuses, static_cast<double>(drive_.refusal.wanted),
          static_cast<double>(drive_.refusal.from), drive_.refusal.waited_ms, mode_awaited ? 1.0 : 0.0);
  }
  if (config_.missed_limit > 0 && drive_.missed >= config_.missed_limit)
    raise(alarm::kPdoMissing, config_.missed_limit, drive_.missed);
}

void Axis::supervise_position() noexcept {
  if (held_ && std::abs(following_error_) > following_limit_)
    raise(alarm::kFollowingError, following_limit_, following_error_, actual_velocity_,
          drive_.torque_known ? drive_.torque_permille : std::numeric_limits<double>::quiet_NaN());
  warn_of_following_error();
  if (held_ && limit_plus_ && limit_minus_) raise(alarm::kBothLimits, 0.0, actual_);
}

/// Once for each time that the error exceeds its warning; it ends well below, so that noise is one
/// exceedance.
void Axis::warn_of_following_error() noexcept {
  const double error = held_ ? std::abs(following_error_) : 0.0;
  if (config_.following_error_warn <= 0.0 || error < 0.9 * following_warn_) following_warned_ = false;
  if (config_.following_error_warn <= 0.0 || following_warned_ || error <= following_warn_) return;
  following_warned_ = true;
  if (error <= following_limit_)
    events_.add({alarm::kFollowingErrorHigh, following_warn_, following_error_, actual_velocity_, 0.0});
}

/// Judges the motion of the cycle before when the switches are read, so that the set-point of this cycle is
/// already the stop's; and once more the motion that began in this cycle.
void Axis::supervise_switches() noexcept {
  if (!held_) return;
  // A program never takes an axis to its switches: one that works is a limit that was passed or a broken
  // wire, wherever the axis goes or rests. Others move away from the switch that they stood on; one that
  // comes on while they move is a stop whichever way they go: wires are swapped, and broken.
  const bool of_program = owner_ == image::AxisOwner::process && (limit_plus_ || limit_minus_);
  const bool by_hand = owner_ != image::AxisOwner::homing;
  const bool into = by_hand && into_limit(set_.v);
  const bool met = by_hand && set_.v != 0.0 && (met_plus_ || met_minus_);
  if (of_program || into || met) {
    const bool plus = into ? set_.v > 0.0 : met ? met_plus_ : limit_plus_;
    raise(plus ? alarm::kHardLimitPlus : alarm::kHardLimitMinus, 0.0, actual_);
    if (!stopped_by_reaction_ && !goes_with_master()) take_away();
  }
}

void Axis::supervise_setpoint() noexcept {
  supervise_switches();
  if (!held_ || set_.v == 0.0) return;
  if (!stopped_by_reaction_ && own_motion_ && leaves_travel(set_)) take_away();
}

/// The state could not come to rest inside the travel any more; raises the alarm.
bool Axis::leaves_travel(const MotionState& state, bool exactly) noexcept {
  if (!homed_ || !config_.travel_limited || state.v == 0.0) return false;
  // The path keeps its limits to 0.1 %, so its own stop may be a little longer than the shortest one.
  const double way = Ramp::stopping_distance(state, config_.limits);
  const double rest = state.x + way, slack = exactly ? 1e-9 : 1e-4 + 0.002 * std::abs(way);
  const bool forward = state.v > 0.0;
  const double limit = forward ? config_.travel_max : config_.travel_min;
  if (forward ? rest <= limit + slack : rest >= limit - slack) return false;
  raise(forward ? alarm::kSoftLimitPlus : alarm::kSoftLimitMinus, limit, rest);
  return true;
}

/// What it means that the drive let go.
void Axis::supervise_power(PowerSequence::State before) noexcept {
  using State = PowerSequence::State;
  if (!power_.lost() || reaction_ >= image::Reaction::quick_stop) return;
  if (before == State::engaging || (before == State::stopping && !moving_)) return;  // as it was told
  power_requested_ = false;
  if (!drive_.online || drive_.state == DriveState::fault ||
      drive_.state == DriveState::fault_reaction_active)
    return;
  if (homing_.drive_led().wants_halt()) return;  // by the quick stop of a drive that has no halt
  const bool opening = before == State::torque || before == State::releasing;
  if (opening && config_.brake.output != BrakeOutput::none)
    raise(alarm::kBrakeNoTorque, 0.0, 0.0);
  else
    raise(alarm::kPowerLostInMotion, 0.0, moving_ ? set_.v : 0.0);
}

/// A closed brake has to hold.
void Axis::supervise_brake() noexcept {
  using State = PowerSequence::State;
  if (config_.brake.output == BrakeOutput::none || !drive_.online) return;
  const bool closed = power_.state() == State::off || power_.state() == State::powering;
  if (closed && brake_marked_) {
    const double slipped = scale_.velocity(static_cast<double>(drive_.position_counts) - brake_mark_);
    if (std::abs(slipped) > config_.brake.slip_window)
      raise(alarm::kBrakeSlips, config_.brake.slip_window, slipped);
  } else {
    brake_mark_ = static_cast<double>(drive_.position_counts);
    brake_marked_ = closed && actual_standing_;
  }
}

/// An axis that was lost or stopped by itself while its process went on along the path: how far from the end
/// of the path it stands, as soon as the drive can tell.
void Axis::supervise_path_end(double dt) noexcept {
  if (!process_given_) return report_path_end(dt);
  if ((held_ && !own_motion_ && !stopped_by_reaction_) || reaction_ >= image::Reaction::stop_and_power_off) {
    off_path_ = false;
    return;
  }
  if (!off_path_) {
    path_moved_ = place_asked_ = false;
    restarts_off_path_ = drive_.restarts;
  }
  off_path_ = true;
  path_moved_ = path_moved_ || process_.velocity != 0.0;
  path_end_ = process_.position;
  off_path_rest_s_ = 0.0;
}

void Axis::report_path_end(double dt) noexcept {
  if (!off_path_) return;
  if (!drive_.online || drive_.restarts != restarts_off_path_) {
    if (path_moved_ && !place_asked_) raise(alarm::kPlaceUnknown, path_end_, actual_);
    place_asked_ = true;
    off_path_ = !drive_.online;
    return;
  }
  off_path_rest_s_ = actual_standing_ ? off_path_rest_s_ + dt : 0.0;
  if (off_path_rest_s_ < kOffPathRest) return;
  off_path_ = false;
  const double off = actual_ - path_end_;
  // Let go where the path stood already, it has only settled into its brake.
  const bool settles = !path_moved_ && config_.brake.output != BrakeOutput::none;
  const double allowed = config_.in_position_window + (settles ? config_.brake.slip_window : 0.0);
  if (std::abs(off) > allowed) raise(alarm::kOffPath, path_end_, off);
}

void Axis::set_in_position_window(double window) noexcept {
  window_ = std::clamp(window, 0.0, config_.following_error_limit);
}

void Axis::update_in_position(double dt) noexcept {
  rest_s_ = moving_ && !(homing_.active() && ramp_.done()) ? 0.0 : rest_s_ + dt;
  const double error = set_.x - actual_;
  const bool inside = held_ && rest_s_ > 0.0 && std::abs(error) <= in_position_window();
  inside_s_ = inside ? inside_s_ + dt : 0.0;
  in_position_ = inside && inside_s_ >= config_.in_position_time;
  if (!held_) rest_s_ = 0.0;
  if (held_ && !inside && config_.in_position_timeout > 0.0 && rest_s_ > config_.in_position_timeout)
    raise(alarm::kInPositionTimeout, in_position_window(), error);
}

bool Axis::present(image::AlarmNumber number) const noexcept {
  switch (number) {
    case alarm::kFollowingError:
      return held_ && std::abs(following_error_) > following_limit_;
    case alarm::kBothLimits:
      return limit_plus_ && limit_minus_;
    case alarm::kDriveFault:
      return drive_.online &&
             (drive_.state == DriveState::fault || drive_.state == DriveState::fault_reaction_active) &&
             !reset_pending_;
    case alarm::kDriveRefuses:
      return drive_.refusal.waited_ms > 0;
    case alarm::kDriveOffline:
      return !drive_.online;
    case alarm::kPdoMissing:
      return config_.missed_limit > 0 && drive_.missed >= config_.missed_limit;
    case alarm::kInPositionTimeout:
      return held_ && rest_s_ > 0.0 && inside_s_ == 0.0;
    default:
      return false;
  }
}

}  // namespace servogate::axis
