// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/master/axis_link.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::board {

namespace {

using image::DriveState;

constexpr double kFilter = 0.2;  ///< of a new speed in the measured one

/// Difference of two values of a counter that runs over.
std::int32_t difference(std::int32_t now, std::int32_t before) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(now) - static_cast<std::uint32_t>(before));
}

}  // namespace

void AxisLink::take_counts(const ChannelStatus& from, const Status& status) noexcept {
  const std::int32_t raw = config_.encoder ? from.counts : from.steps;
  const std::int32_t way = counts_known_ ? difference(raw, raw_counts_) : raw;
  const std::int64_t moved = config_.encoder || !config_.reversed ? way : -std::int64_t{way};
  if (counts_known_) {
    const double span = static_cast<std::uint32_t>(status.t_us - t_us_) * 1e-6;
    if (span > 0.0) velocity_ += kFilter * (static_cast<double>(moved) / span - velocity_);
  } else {
    velocity_ = 0.0;
  }
  counts_ = counts_known_ ? counts_ + moved : moved;
  counts_known_ = true;
  raw_counts_ = raw;
  t_us_ = status.t_us;
  if (from.latches == latches_) return;
  latches_ = from.latches;
  latched_ = counts_ + difference(from.latched, raw);
  ++captures_;
}

void AxisLink::receive(const Session& session, bool fresh, image::DriveFeedback& to) noexcept {
  if (session.sessions() != session_) {
    session_ = session.sessions();
    ++restarts_;
    counts_known_ = false;
    latches_ = 0;
    on_ = false;
  }
  online_ = session.state() == SessionState::running && (fresh || counts_known_);
  missed_ = fresh ? 0 : missed_ + 1;
  const Status& status = session.status();
  const auto mask = static_cast<std::uint8_t>(1u << config_.channel);
  if (fresh) {
    take_counts(status.channels[config_.channel], status);
    steps_ = status.channels[config_.channel].steps;
    enabled_ = (status.enabled & mask) != 0;
    fault_ = (status.faults & mask) != 0;
    tripped_ = (status.flags & kTripped) != 0;
  }
  to.online = online_;
  to.restarts = restarts_;
  to.missed = online_ ? missed_ : 0;
  if (!online_) {
    to.state = DriveState::offline;
    return;
  }
  to.position_counts = counts_;
  to.velocity_counts_s = velocity_;
  to.error_code = tripped_ ? kErrorTripped : fault_ ? kErrorFaultInput : std::uint16_t{0};
  to.state = tripped_ || fault_   ? DriveState::fault
             : enabled_ && quick_ ? DriveState::quick_stop_active
             : enabled_ && on_    ? DriveState::operation_enabled
             : on_                ? DriveState::switched_on
                                  : DriveState::switch_on_disabled;
  to.mode = enabled_ ? image::DriveMode::csp : image::DriveMode::none;
  to.latch_counts = latched_;
  to.latch_sequence = captures_;
}

std::int64_t AxisLink::steps_of(std::int64_t counts) const noexcept {
  // Whole and rest apart: the product stays within 64 bits, and nothing is lost however long it runs.
  const std::int64_t whole = counts / config_.counts, rest = counts % config_.counts;
  const std::int64_t part = rest * config_.steps, half = config_.counts / 2;
  return whole * config_.steps + (part + (part < 0 ? -half : half)) / config_.counts;
}

/// The goal of this cycle: the kernel's set-point, or the ramp of a quick stop.
void AxisLink::move(const image::DriveCommand& from, double dt) noexcept {
  goal_read_ = goal_before_;
  goal_before_ = goal_;
  if (!from.quick_stop) {
    goal_ = from.position_counts;
    quick_ = false;
    return;
  }
  if (!quick_) {
    quick_ = true;
    stopped_ = false;
    ramp_ = static_cast<double>(goal_before_ - goal_read_) / dt;
    ramp_rest_ = 0.0;
  }
  const double slower = config_.quick_stop * dt;
  ramp_ = std::abs(ramp_) <= slower ? 0.0 : ramp_ - std::copysign(slower, ramp_);
  const double way = ramp_ * dt + ramp_rest_;
  const double whole = std::trunc(way);
  ramp_rest_ = way - whole;
  goal_ += static_cast<std::int64_t>(whole);
  if (ramp_ == 0.0) stopped_ = true;
}

ChannelCommand AxisLink::step_command(double dt) const noexcept {
  const std::int64_t sign = config_.reversed ? -1 : 1;
  const std::int64_t target = sign * steps_of(goal_ - zero_counts_);
  const std::int64_t before = sign * steps_of(goal_before_ - zero_counts_);
  const double rate = std::clamp(static_cast<double>(target - before) / dt, -2e9, 2e9);
  return {static_cast<std::int32_t>(static_cast<std::uint32_t>(zero_steps_) +
                                    static_cast<std::uint32_t>(target & 0xFFFFFFFF)),
          static_cast<std::int32_t>(rate)};
}

ChannelCommand AxisLink::speed_command(double velocity) const noexcept {
  const double share =
      velocity / config_.full_scale_counts_s * (config_.reversed ? -1.0 : 1.0) + config_.offset;
  return {static_cast<std::int32_t>(std::lround(std::clamp(share, -1.0, 1.0) * kFullScale)), 0};
}

void AxisLink::send(const image::DriveCommand& from, double dt, Command& to) noexcept {
  const auto mask = static_cast<std::uint8_t>(1u << config_.channel);
  if (from.reset_fault) to.flags |= kResetTrip;
  if (from.latch_arm) to.latch |= mask;
  const bool begins = !on_ || !enabled_;
  on_ = from.power && online_ && !tripped_ && !fault_ && !(quick_ && stopped_ && from.quick_stop);
  if (!on_) {
    quick_ = quick_ && from.quick_stop;
    goal_ = goal_before_ = goal_read_ = from.position_counts;
    return;
  }
  to.enable |= mask;
  if (begins) {
    // Here is where it stands: no way to a place of earlier.
    goal_ = goal_before_ = goal_read_ = zero_counts_ = from.position_counts;
    zero_steps_ = steps_;
    quick_ = false;
  } else {
    move(from, dt);
  }
  if (config_.output == Output::step) {
    to.channels[config_.channel] = step_command(dt);
    return;
  }
  // What was read now was latched when the set-point of the last cycle but one should have been reached.
  const double error = static_cast<double>(goal_read_ - counts_);
  const double feed = static_cast<double>(goal_ - goal_before_) / dt;
  to.channels[config_.channel] = speed_command(begins ? 0.0 : feed + config_.position_gain * error);
}

}  // namespace servogate::board
