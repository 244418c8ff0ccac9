// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/follower.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr int kEntriesPerCycle = 256;   // taken over from the track
constexpr int kMarkersPerCycle = 16;    // passed at rest
constexpr int kSpansPerCycle = 16;      // the planner lets no more than four be passed
constexpr int kBridgedSpans = 96;       // the longest way to rest across spans
constexpr int kSlowSpans = 12;          // among them, slower than the motion is now
constexpr double kSlowestShare = 1e-6;  // of a feed; slower is rest
constexpr double kSamePlace = 1e-9;     // mm

/// Speed that is reached when the acceleration is taken back at once.
double settled_speed(const MotionState& m, const Box& box) {
  return m.v + 0.5 * m.a * std::abs(m.a) / box.jerk;
}

}  // namespace

Follower::Follower(const Config& config, Track& track)
    : config_(config), track_(track), window_(track.entries.capacity()) {}

void Follower::set_override(double ratio) noexcept {
  const double r = ratio >= kSlowestShare ? std::min(ratio, config_.largest_override) : 0.0;
  if (r == override_) return;
  override_ = r;
  stale_ = true;
}

void Follower::set_spindle(double revolutions) noexcept {
  if (revolutions == spindle_) return;
  spindle_ = revolutions;
  const auto follows = [&](std::uint64_t n) {
    return n < last_ && entry_at(n).kind == Entry::Kind::span && entry_at(n).span.per_turn > 0.0;
  };
  stale_ = stale_ || follows(first_) || follows(first_ + 1);
}

/// Of the speed that the span is planned for.
double Follower::spindle_share(const Span& span) const noexcept {
  return span.per_turn > 0.0 && spindle_ >= 0.0 ? spindle_ / span.turns : 1.0;
}

bool Follower::spindle_stands() const noexcept {
  return !empty() && front().kind == Entry::Kind::span && spindle_share(front().span) < kSlowestShare;
}

void Follower::release_event() noexcept {
  if (!wait_event_) return;
  wait_event_ = false;
  ++first_;
}

void Follower::release_stop() noexcept { wait_stop_ = false; }

void Follower::skip_to(const Track::Begin& begin) noexcept {
  if (taken_ >= begin.entry) return;
  first_ = last_ = staged_;
  taken_ = begin.entry;
  track_.entries.free_below(taken_);
  track_.pieces.free_below(begin.piece);
  in_span_ = bridging_ = wait_stop_ = wait_event_ = open_ = stopping_ = false;
  dropping_ = true;
  state_ = {};
}

bool Follower::set_position(const Vector& at) noexcept {
  if (in_span_ || !at_rest()) return false;
  sample_.position = at;
  fault_ = false;
  return true;
}

void Follower::take_entries(std::uint64_t visible) noexcept {
  for (int n = 0; n < kEntriesPerCycle && taken_ < visible && staged_ - first_ < window_.size(); ++n) {
    const Entry& entry = track_.entries[taken_++];
    if (entry.kind == Entry::Kind::raise) {
      raise(entry.span);
    } else if (!dropping_ || entry.kind == Entry::Kind::restart || staged_ != first_) {
      // While dropping, the window holds at most the restart: what comes behind it belongs to the new path.
      entry_at(staged_++) = entry;
      if (!entry.more) last_ = staged_;
    } else if (entry.kind == Entry::Kind::span) {
      track_.pieces.free_below(entry.span.first_piece + entry.span.pieces);
    }
  }
  track_.entries.free_below(taken_);
}

void Follower::raise(const Span& update) noexcept {
  // Numbers rise along the window, and a marker carries the number of the span before it: the first entry
  // that is not below is the span, if it is still there.
  std::uint64_t low = first_, high = last_;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (entry_at(middle).span.number < update.number)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == last_ || entry_at(low).kind != Entry::Kind::span || entry_at(low).span.number != update.number)
    return;
  Span& span = entry_at(low).span;
  span.exit_limit = update.exit_limit;
  span.exit_nominal = update.exit_nominal;
  span.final = update.final;
  span.stop = update.stop;
  span.confirm = update.confirm;
  if (in_span_ && low == first_) stale_ = true;
}

bool Follower::pass_marker(const Entry& entry) noexcept {
  switch (entry.kind) {
    case Entry::Kind::event:
      open_ = false;
      wait_event_ = true;
      return false;
    case Entry::Kind::finish:
      open_ = false;
      break;
    case Entry::Kind::restart:
      open_ = dropping_ = stopping_ = false;
      fault_ = false;
      for (int i = 0; i < config_.axis_count; ++i)
        fault_ = fault_ || !(std::abs(entry.at[i] - sample_.position[i]) <= kSamePlace);
      if (fault_) dropping_ = true;
      break;
    default:
      break;
  }
  ++first_;
  return true;
}

void Follower::pass_markers() noexcept {
  for (int n = 0; n < kMarkersPerCycle && !wait_stop_ && !wait_event_ && !empty(); ++n) {
    if (dropping_ && front().kind != Entry::Kind::restart) return drop();
    if (front().kind == Entry::Kind::span || !pass_marker(front())) return;
  }
}

void Follower::start() noexcept {
  pass_markers();
  if (wait_stop_ || wait_event_ || empty() || dropping_ || wants_rest()) return;
  if (front().kind == Entry::Kind::span && front().span.final) enter();
}

void Follower::enter() noexcept {
  in_span_ = open_ = true;
  state_.s = 0.0;
  clock_ = 0.0;
  piece_ = front().span.first_piece;
  profile_.start(state_);
  resting_wanted_ = wants_rest();
  stale_ = false;
  if (replan()) return;
  // Rounding at the border of what is feasible: leave as slowly as possible.
  Goal slow = goal(state_);
  slow.exit_limit = slow.exit = slow.velocity = front().span.box.velocity;
  plan(profile_, state_, slow, front().span.box);
}

void Follower::leave() noexcept {
  const Span& span = front().span;
  const Piece& last = track_.pieces[span.first_piece + span.pieces - 1];
  sample_.position = servogate::path::position(last, last.length, config_.axis_count);
  sample_.target = last.target;
  sample_.tag = last.tag;
  sample_.rapid = last.rapid;
  sample_.distance_to_go = last.rest;
  wait_stop_ = span.stop && span.confirm;
  const bool stop = span.stop;
  track_.pieces.free_below(span.first_piece + span.pieces);
  in_span_ = false;
  ++first_;
  if (!stop && !empty() && front().kind == Entry::Kind::span) {
    enter();
  } else {
    state_ = {};
  }
}

void Follower::drop() noexcept {
  last_ = staged_;
  while (!empty() && front().kind != Entry::Kind::restart) {
    if (front().kind == Entry::Kind::span)
      track_.pieces.free_below(front().span.first_piece + front().span.pieces);
    ++first_;
  }
  in_span_ = wait_stop_ = wait_event_ = open_ = stopping_ = false;
  dropping_ = true;
  state_ = {};
}

Goal Follower::goal(const MotionState& from) const noexcept {
  const Span& span = front().span;
  Goal g;
  g.length = span.length - from.s;
  g.exit_limit = span.exit_limit;
  if (wants_rest()) return g;
  const bool rapid = track_.pieces[piece_].rapid;
  const double wish = rapid ? std::min(override_, 1.0) : override_;
  const auto asked = [&](const Span& of) {
    return wish * (of.per_turn > 0.0 && spindle_ >= 0.0 ? of.per_turn * spindle_ : of.feed);
  };
  const double r = std::min(wish * spindle_share(span), config_.largest_override);
  g.velocity = std::min(span.box.velocity, asked(span));
  g.exit = std::min(span.exit_nominal, g.velocity);
  if (r > 1.0) {
    const double share = (r - 1.0) / std::max(config_.largest_override - 1.0, 1e-9);
    g.exit = std::min(g.velocity, span.exit_nominal + share * (span.exit_limit - span.exit_nominal));
  }
  if (first_ + 1 < last_) {
    const Entry& behind = window_[(first_ + 1) % window_.size()];
    if (behind.kind == Entry::Kind::span) g.exit = std::min(g.exit, asked(behind.span));
  }
  return g;
}

bool Follower::replan() noexcept {
  const MotionState from = state_;
  if (!plan(profile_, from, goal(from), front().span.box)) return false;
  const MotionState& end = profile_.end();
  if (std::abs(end.s - front().span.length) < kSamePlace * 0.1)
    profile_.finish_at({front().span.length, end.v, end.a});
  clock_ = 0.0;
  bridging_ = false;
  base_ = 0.0;
  return true;
}

/// True when the way to rest enters each span behind the present one no faster than its box allows, and not
/// speeding up.
bool Follower::bridge_clears(const Profile& way, int spans, const Box& least) const noexcept {
  const double fastest = std::max(state_.v, settled_speed(state_, least));
  double place = front().span.length;
  int slow = 0;
  for (int n = 1; n <= spans; ++n) {
    const Span& span = window_[(first_ + static_cast<std::uint64_t>(n)) % window_.size()].span;
    if (state_.a > 0.0 || fastest > span.box.velocity) {
      if (++slow > kSlowSpans) return false;
      double early = 0.0, late = way.duration();
      for (int round = 0; round < 30; ++round) {
        const double middle = 0.5 * (early + late);
        (way.at(middle).s < place ? early : late) = middle;
      }
      const MotionState there = way.at(early);
      if (there.a > 0.0 || there.v > span.box.velocity) return false;
    }
    place += span.length;
  }
  return true;
}

/// The fastest way to rest that any of the spans it crosses allows, instead of one S-curve in each of them.
bool Follower::bridge() noexcept {
  Box least = front().span.box;
  double known = front().span.length - state_.s;
  for (int n = 0; n <= kBridgedSpans; ++n) {
    // With the lower jerk of a span ahead the acceleration may take too long to be taken back: the motion
    // would become too fast, or turn back.
    const double settled = settled_speed(state_, least);
    if (std::abs(state_.a) > least.acceleration || settled < 0.0) return false;
    if (state_.a > 0.0 && settled > front().span.box.velocity) return false;
    const double way = ramp_distance(state_.v, state_.a, 0.0, least);
    if (way <= known) {
      Profile profile;
      profile.start(state_);
      add_ramp(profile, state_.v, state_.a, 0.0, least);
      profile.finish_at({state_.s + way, 0.0, 0.0});
      if (!bridge_clears(profile, n, least)) return false;
      profile_ = profile;
      clock_ = base_ = 0.0;
      bridging_ = true;
      return true;
    }
    const std::uint64_t next = first_ + static_cast<std::uint64_t>(n) + 1;
    if (next >= last_ || entry_at(next - 1).span.stop || entry_at(next).kind != Entry::Kind::span)
      return false;
    const Span& span = entry_at(next).span;
    known += span.length;
    least.acceleration = std::min(least.acceleration, span.box.acceleration);
    least.jerk = std::min(least.jerk, span.box.jerk);
  }
  return false;
}

/// Moves on to the span in which a bridging profile has arrived.
void Follower::pass_spans() noexcept {
  for (int n = 0; n < kSpansPerCycle && state_.s > front().span.length && first_ + 1 < last_; ++n) {
    const Span& span = front().span;
    base_ += span.length;
    state_.s -= span.length;
    track_.pieces.free_below(span.first_piece + span.pieces);
    ++first_;
    piece_ = front().span.first_piece;
  }
}

void Follower::advance() noexcept {
  if (bridging_) {
    clock_ = std::min(clock_ + config_.period_s, profile_.duration());
    state_ = profile_.at(clock_);
    state_.s -= base_;
    return pass_spans();
  }
  double left = config_.period_s;
  for (int n = 0; n < kSpansPerCycle && in_span_; ++n) {
    const double until_end = profile_.duration() - clock_;
    if (left < until_end) {
      clock_ += left;
      state_ = profile_.at(clock_);
      return;
    }
    clock_ = profile_.duration();
    state_ = profile_.end();
    if (state_.s < front().span.length)
      return;  // at rest on the path, or a profile that must be planned anew
    left -= std::max(0.0, until_end);
    leave();
  }
}

void Follower::locate() noexcept {
  const Span& span = front().span;
  const std::uint64_t last = span.first_piece + span.pieces - 1;
  while (piece_ < last && state_.s > track_.pieces[piece_].start + track_.pieces[piece_].length) ++piece_;
  track_.pieces.free_below(piece_);
}

FollowerState Follower::report() const noexcept {
  if (fault_) return FollowerState::fault;
  if (wait_event_) return FollowerState::at_event;
  if (wait_stop_) return FollowerState::at_stop;
  if (in_span_) {
    if (!rest_asked()) return FollowerState::moving;
    return at_rest() ? FollowerState::held : FollowerState::holding;
  }
  if (dropping_) return FollowerState::stopped;
  if (empty()) return FollowerState::idle;
  return rest_asked() ? FollowerState::held : FollowerState::moving;
}

Sample Follower::sample() noexcept {
  const int n = config_.axis_count;
  sample_.velocity = sample_.acceleration = Vector{};
  sample_.feed = 0.0;
  if (in_span_) {
    locate();
    const Piece& piece = track_.pieces[piece_];
    const double s = std::clamp(state_.s - piece.start, 0.0, piece.length), v = state_.v;
    const PathPoint at = evaluate(piece, s, n);
    double linear = 0.0, turning = 0.0;
    for (int i = 0; i < n; ++i) {
      sample_.position[i] = at.x[i];
      sample_.velocity[i] = at.d1[i] * v;
      sample_.acceleration[i] = at.d2[i] * v * v + at.d1[i] * state_.a;
      (config_.rotary[i] ? turning : linear) += sample_.velocity[i] * sample_.velocity[i];
    }
    sample_.feed = std::sqrt(linear > 1e-12 * turning ? linear : turning);
    const bool blend = piece.shape == Piece::Shape::blend,
               early = blend && piece.tag_before != piece.tag && s < 0.5 * piece.length;
    sample_.tag = early ? piece.tag_before : piece.tag;
    sample_.distance_to_go = early ? 0.5 * piece.length - s : piece.rest + piece.length - s;
    sample_.target = piece.target;
    sample_.rapid = piece.rapid;
  }
  sample_.state = report();
  sample_.event = wait_event_ ? front().event : 0;
  sample_.starved = starved_;
  return sample_;
}

Sample Follower::step(std::uint64_t visible) noexcept {
  take_entries(visible);
  if (!in_span_) start();
  if (stopping_ && at_rest()) drop();
  if (in_span_) {
    const bool rest_wanted = wants_rest();
    if (rest_wanted != resting_wanted_) stale_ = true;
    resting_wanted_ = rest_wanted;
    if (stale_ && !(rest_wanted && bridging_)) stale_ = !replan();
    if (rest_wanted && !bridging_ && profile_.end().v > 0.0) bridge();
    if (!front().span.final && !rest_wanted) ++starved_;
    advance();
    if (!in_span_) pass_markers();
  } else if (open_ && !wait_stop_ && !wait_event_ && !wants_rest()) {
    ++starved_;
  }
  return sample();
}

}  // namespace servogate::path
