// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/master/session.hpp"

#include <algorithm>

namespace servogate::board {

namespace {

constexpr image::Nanoseconds kAskAgain = 100 * image::kMillisecond;
constexpr image::Nanoseconds kAskRefused = 2 * image::kSecond;  ///< another firmware may have come

Refused refusal_of(const Configured& c) noexcept {
  switch (c.result) {
    case ConfigureResult::done:
      return {};
    case ConfigureResult::no_watchdog:
      return {RefusedFor::watchdog};
    case ConfigureResult::no_period:
      return {RefusedFor::period};
    case ConfigureResult::no_such_channel:
      return {RefusedFor::channel, c.channel};
    case ConfigureResult::no_such_output:
      break;
  }
  return {RefusedFor::output, c.channel};
}

}  // namespace

Session::Session(const Configuration& configuration, const Needs& needs) noexcept
    : configuration_(configuration),
      needs_(needs),
      silence_ns_(configuration.watchdog_us * image::kMicrosecond / 2) {}

void Session::begin() noexcept {
  state_ = SessionState::silent;
  asked_ns_ = -image::kSecond;
  fresh_ = false;
}

bool Session::take_fresh() noexcept {
  const bool fresh = fresh_;
  fresh_ = false;
  return fresh;
}

bool Session::take(std::span<const std::uint8_t> bytes, image::Nanoseconds t) noexcept {
  Message m;
  if (!parse(bytes, m)) return false;
  switch (m.header.kind) {
    case Kind::description:
      take_description(m.body, t);
      return false;
    case Kind::configured:
      take_configured(m, t);
      return false;
    case Kind::status: {
      Status s;
      if (state_ != SessionState::running || !board::take(m.body, s)) return false;
      status_ = s;
      take_status(m.header.sequence, t);
      return true;
    }
    case Kind::refused:
      // It has restarted since: its counters are others.
      if (state_ == SessionState::running) begin();
      return false;
    default:
      return false;
  }
}

void Session::take_description(std::span<const std::uint8_t> body, image::Nanoseconds t) noexcept {
  Description d;
  if (state_ != SessionState::silent) return;
  // Of another version only the number in front is known.
  if (body.size() >= 2) d.protocol = static_cast<std::uint16_t>(body[0] | body[1] << 8);
  if (d.protocol == kProtocolVersion && !board::take(body, d)) return;
  description_ = d;
  refused_ = lack();
  state_ = refused_.why == RefusedFor::none ? SessionState::configuring : SessionState::refused;
  asked_ns_ = state_ == SessionState::refused ? t : t - kAskAgain;
}

/// What the board that has described itself does not have.
Refused Session::lack() const noexcept {
  const Description& d = description_;
  if (d.protocol != kProtocolVersion) return {RefusedFor::protocol, kProtocolVersion, d.protocol};
  if (needs_.inputs > d.inputs) return {RefusedFor::inputs, needs_.inputs, d.inputs};
  if (needs_.outputs > d.outputs) return {RefusedFor::outputs, needs_.outputs, d.outputs};
  if (needs_.analog_inputs > d.analog_inputs)
    return {RefusedFor::analog_inputs, needs_.analog_inputs, d.analog_inputs};
  if (needs_.analog_outputs > d.analog_outputs)
    return {RefusedFor::analog_outputs, needs_.analog_outputs, d.analog_outputs};
  for (std::uint32_t n = 0; n < kChannels; ++n)
    if ((needs_.encoders >> n & 1u) != 0 && (d.capabilities[n] & kHasEncoder) == 0)
      return {RefusedFor::encoder, n};
  if (needs_.step_rate > d.max_step_rate) return {RefusedFor::step_rate, needs_.step_rate, d.max_step_rate};
  return {};
}

void Session::take_configured(const Message& m, image::Nanoseconds t) noexcept {
  Configured c;
  if (state_ != SessionState::configuring || m.header.sequence != configure_sequence_ ||
      !board::take(m.body, c))
    return;
  refused_ = refusal_of(c);
  state_ = c.result == ConfigureResult::done ? SessionState::running : SessionState::refused;
  asked_ns_ = heard_ns_ = t;
  fresh_ = false;
  ahead_known_ = false;
  stamps_ = 0;
  ++sessions_;
}

void Session::take_status(std::uint32_t sequence, image::Nanoseconds t) noexcept {
  fresh_ = true;
  heard_ns_ = t;
  const std::int64_t before = board_us_;
  board_us_ = ahead_known_
                  ? before + static_cast<std::int32_t>(status_.t_us - static_cast<std::uint32_t>(before))
                  : std::int64_t{status_.t_us};
  if (sequence_ - sequence >= kSent) return;
  const image::Nanoseconds ahead = board_us_ * image::kMicrosecond - sent_ns_[sequence % kSent];
  if (!ahead_known_) {
    ahead_ns_ = ahead_before_ns_ = ahead;
    ahead_known_ = true;
  }
  ahead_ns_ = std::min(ahead_ns_, ahead);
  if (++stamps_ % kWindow != 0) return;
  ahead_before_ns_ = ahead_ns_;
  ahead_ns_ = ahead;
}

image::Nanoseconds Session::machine_time(std::uint32_t t_us) const noexcept {
  const std::int64_t us = board_us_ + static_cast<std::int32_t>(t_us - static_cast<std::uint32_t>(board_us_));
  return us * image::kMicrosecond - std::min(ahead_ns_, ahead_before_ns_);
}

std::size_t Session::next(const Command& command, image::Nanoseconds t,
                          std::span<std::uint8_t> buffer) noexcept {
  if (state_ == SessionState::refused) {
    if (t - asked_ns_ < kAskRefused) return 0;
    begin();
  }
  if (state_ == SessionState::running && t - heard_ns_ > silence_ns_) begin();
  if (state_ == SessionState::running) {
    sent_ns_[++sequence_ % kSent] = t;
    return put({Kind::cycle, sequence_}, command, buffer);
  }
  if (t - asked_ns_ < kAskAgain) return 0;
  asked_ns_ = t;
  if (state_ == SessionState::silent) return put({Kind::describe, ++sequence_}, buffer);
  configure_sequence_ = ++sequence_;
  return put({Kind::configure, configure_sequence_}, configuration_, buffer);
}

}  // namespace servogate::board
