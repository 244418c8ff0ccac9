// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/master/session.hpp"

#include <algorithm>

namespace servogate::board {

namespace {

constexpr image::Nanoseconds kAskAgain = 100 * image::kMillisecond;

}  // namespace

Session::Session(const Configuration& configuration) noexcept
    : configuration_(configuration), silence_ns_(configuration.watchdog_us * image::kMicrosecond / 2) {}

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
  if (state_ != SessionState::silent || !board::take(body, d)) return;
  description_ = d;
  configured_ = {};
  state_ = d.protocol == kProtocolVersion ? SessionState::configuring : SessionState::refused;
  asked_ns_ = t - kAskAgain;
}

void Session::take_configured(const Message& m, image::Nanoseconds t) noexcept {
  Configured c;
  if (state_ != SessionState::configuring || m.header.sequence != configure_sequence_ ||
      !board::take(m.body, c))
    return;
  configured_ = c;
  state_ = c.result == ConfigureResult::done ? SessionState::running : SessionState::refused;
  heard_ns_ = t;
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
  if (state_ == SessionState::refused) return 0;
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
