// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/follower.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr int kEntriesPerCycle = 256;   // taken over from the track
constexpr int kMarkersPerCycle = 16;    // passed at rest
constexpr int kPiecesPerCycle = 64;     // passed
constexpr int kPiecesLocated = 512;     // of a course, where more are passed the place shown comes late
constexpr double kSlowestShare = 1e-6;  // of a feed; slower is rest
constexpr double kSamePlace = 1e-9;     // mm

}  // namespace

Follower::Follower(const Config& config, Track& track)
    : config_(config),
      track_(track),
      window_(track),
      course_(track),
      rate_({config.axis_count, config.limits, config.transformation}),
      master_(config) {}

void Follower::set_override(double ratio) noexcept {
  const double r = ratio >= kSlowestShare ? std::min(ratio, config_.largest_override) : 0.0;
  if (r == override_) return;
  override_ = r;
  motion_.renew();
}

void Follower::set_spindle(double revolutions) noexcept {
  if (revolutions == spindle_) return;
  spindle_ = revolutions;
  const Span* span = window_.span(0);
  if (span != nullptr && span->terms.feed.per_turn > 0.0) motion_.renew();
}

bool Follower::spindle_stands() const noexcept {
  const Span* span = window_.span(0);
  return (span != nullptr ? spindle_share(span->terms.feed, spindle_) : course_share()) < kSlowestShare;
}

void Follower::release_event() noexcept {
  if (!wait_event_) return;
  wait_event_ = false;
  window_.pop();
}

void Follower::release_stop() noexcept { wait_stop_ = false; }

void Follower::skip_to(const Track::Begin& begin) noexcept {
  if (taken_ >= begin.entry) return;
  window_.clear();
  taken_ = begin.entry;
  track_.entries.free_below(taken_);
  track_.pieces.free_below(begin.piece);
  track_.knots.free_below(begin.knot);
  track_.stops.free_below(begin.stop);
  in_span_ = on_course_ = by_master_ = wait_stop_ = wait_event_ = open_ = stopping_ = false;
  dropping_ = true;
  begun_ = begin.piece;
  motion_.rest();
}

bool Follower::set_position(const Vector& at) noexcept {
  if (in_span_ || !at_rest()) return false;
  sample_.position = at;
  fault_ = false;
  return true;
}

void Follower::take_entries(std::uint64_t visible) noexcept {
  for (int n = 0; n < kEntriesPerCycle && taken_ < visible && !window_.full(); ++n) {
    const Entry& entry = track_.entries[taken_++];
    if (entry.kind == Entry::Kind::extend) {
      if (!window_.extend(entry)) drop_course(entry);
    } else if (!dropping_ || entry.kind == Entry::Kind::restart || !window_.empty()) {
      // While dropping, the window holds at most the restart: what comes behind it belongs to the new path.
      window_.append(entry);
    } else if (entry.kind == Entry::Kind::span) {
      drop_span(entry.span);
    }
  }
  track_.entries.free_below(taken_);
}

bool Follower::pass_marker(const Entry& entry) noexcept {
  switch (entry.kind) {
    case Entry::Kind::event:
      pass_marks(entry.tag.marks, 0.0);
      open_ = false;
      wait_event_ = true;
      return false;
    case Entry::Kind::finish:
      pass_marks(entry.tag.marks, 0.0);
      open_ = false;
      break;
    case Entry::Kind::restart: {
      open_ = dropping_ = stopping_ = false;
      fault_ = false;
      const Vector at = to_axes(config_, entry.at);
      for (int i = 0; i < config_.axis_count; ++i)
        fault_ = fault_ || !(std::abs(at[i] - sample_.position[i]) <= kSamePlace);
      if (fault_) dropping_ = true;
      begun_ = entry.span.first_piece;
      marks_ = entry.tag.marks;
      break;
    }
    default:
      break;
  }
  window_.pop();
  return true;
}

void Follower::pass_markers() noexcept {
  for (int n = 0; n < kMarkersPerCycle && !wait_stop_ && !wait_event_ && !window_.empty(); ++n) {
    const Entry& entry = window_.front();
    if (dropping_ && entry.kind != Entry::Kind::restart) return drop();
    if (entry.kind == Entry::Kind::course && entry.extent.broken && entry.extent.stops == 0) {
      leave_broken_course();  // there is no way on it
      continue;
    }
    const bool way = entry.kind == Entry::Kind::span || entry.kind == Entry::Kind::course;
    if (way || !pass_marker(entry)) return;
  }
}

void Follower::start() noexcept {
  pass_markers();
  if (wait_stop_ || wait_event_ || dropping_ || rest_asked()) return;
  const Span* span = window_.span(0);
  const bool by_angle = span != nullptr && span->terms.feed.lock.kind != Lock::Kind::none;
  if (by_angle) {  // whether its spindle stands is its own affair
    if (begin_by_master()) enter();
    return;
  }
  if (spindle_stands()) return;
  if (span != nullptr) {
    enter();
    motion_.begin(*span, wish());
  } else if (const Entry* course = window_.course(); course != nullptr) {
    begin_course(*course);
  }
}

void Follower::enter() noexcept {
  in_span_ = open_ = true;
  piece_ = front().first_piece;
}

void Follower::leave() noexcept {
  const Span span = front();
  window_.pop();
  arrive(track_.pieces[span.first_piece + span.pieces - 1], span.confirm);
  track_.pieces.free_below(span.first_piece + span.pieces);
}

/// At rest in the end of a piece.
void Follower::arrive(const Piece& last, bool waits) noexcept {
  sample_.position = to_axes(config_, servogate::path::position(last, last.length, config_.axis_count));
  sample_.target = to_axes(config_, last.target);
  sample_.tag = last.tag;
  sample_.rapid = last.rapid;
  sample_.distance_to_go = last.rest;
  pass_marks(last.tag.marks, 0.0);
  wait_stop_ = waits;
  in_span_ = on_course_ = by_master_ = false;
  motion_.rest();
}

void Follower::drop_span(const Span& span) noexcept {
  begun_ = span.first_piece + span.pieces;
  track_.pieces.free_below(begun_);
}

void Follower::drop() noexcept {
  while (!window_.empty() && window_.front().kind != Entry::Kind::restart) {
    if (window_.span(0) != nullptr) drop_span(front());
    if (window_.course() != nullptr) drop_course(*window_.course());
    window_.pop();
  }
  in_span_ = on_course_ = by_master_ = wait_stop_ = wait_event_ = open_ = stopping_ = false;
  dropping_ = true;
  motion_.rest();
}

void Follower::locate(double s) noexcept {
  const std::uint64_t last =
      on_course_ ? course_.behind().piece - 1 : front().first_piece + front().pieces - 1;
  for (int n = 0; n < kPiecesLocated && piece_ < last; ++n, ++piece_)
    if (s <= track_.pieces[piece_].start + track_.pieces[piece_].length) break;
  track_.pieces.free_below(piece_);
}

/// Length of the path from the last mark to the place `s` in the piece in motion; the pieces that one cycle
/// passes are still on the track behind it.
double Follower::behind_mark(std::uint32_t marks, double s) const noexcept {
  double length = s;
  std::uint64_t n = piece_;
  const std::uint64_t oldest = std::max(begun_, track_.pieces.oldest());
  for (int k = 0; k < kPiecesPerCycle && n > oldest && track_.pieces[n - 1].tag.marks == marks; ++k)
    length += track_.pieces[--n].length;
  return length;
}

/// `beyond`: share of a cycle since the last of them.
void Follower::pass_marks(std::uint32_t marks, double beyond) noexcept {
  if (static_cast<std::int32_t>(marks - marks_) <= 0) return;
  sample_.passed += marks - marks_;
  sample_.passed_at = std::clamp(1.0 - beyond, 0.0, 1.0);
  marks_ = marks;
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
  if (window_.empty()) return FollowerState::idle;
  return rest_asked() ? FollowerState::held : FollowerState::moving;
}

void Follower::show_feed(const Vector& velocity) noexcept {
  sample_.feed = norm(velocity, config_.axis_count);
}

void Follower::place_course_on_axes() noexcept {
  const CoursePoint at = rate_.point(course_);
  locate(at.place);
  sample_.position = at.x;
  sample_.velocity = at.v;
  sample_.acceleration = at.a;
  show_feed(at.v);
  const Piece& piece = track_.pieces[piece_];
  show_piece(std::clamp(at.place - piece.start, 0.0, piece.length), at.speed);
}

/// Where the motion is in its span, as the set-point of the axes.
void Follower::place_span_on_axes() noexcept {
  const MotionState& state = motion_.state();
  locate(state.s);
  const Piece& piece = track_.pieces[piece_];
  place_on_axes(std::clamp(state.s - piece.start, 0.0, piece.length), state);
}

/// `s` along the piece in motion.
void Follower::place_on_axes(double s, const MotionState& state) noexcept {
  const int n = config_.axis_count;
  const Piece& piece = track_.pieces[piece_];
  const double v = state.v;
  PathPoint at = evaluate(piece, s, n);
  Vector along{};
  for (int i = 0; i < n; ++i) along[i] = at.d1[i] * v;
  show_feed(along);
  config_.transformation->to_axes(at, n);
  for (int i = 0; i < n; ++i) {
    sample_.position[i] = at.x[i];
    sample_.velocity[i] = at.d1[i] * v;
    sample_.acceleration[i] = at.d2[i] * v * v + at.d1[i] * state.a;
  }
  show_piece(s, v);
}

/// What the piece in motion says, `s` behind its begin at speed v.
void Follower::show_piece(double s, double v) noexcept {
  const Piece& piece = track_.pieces[piece_];
  sample_.tag = piece.tag;
  if (sample_.tag.marks != marks_) {
    const double cycle = std::max(v * config_.period_s, kSamePlace);
    pass_marks(sample_.tag.marks, behind_mark(sample_.tag.marks, s) / cycle);
  }
  sample_.distance_to_go = piece.rest + piece.length - s;
  if (shown_ == piece_) return;
  shown_ = piece_;
  sample_.rapid = piece.rapid;
  sample_.target = to_axes(config_, piece.target);
}

Sample Follower::sample() noexcept {
  if (on_course_) {
    place_course_on_axes();
  } else if (in_span_ && by_master_) {
    place_master_on_axes();
  } else if (in_span_) {
    place_span_on_axes();
  } else {
    sample_.velocity = sample_.acceleration = Vector{};
    sample_.feed = 0.0;
  }
  sample_.state = report();
  sample_.event = wait_event_ ? window_.front().event : 0;
  sample_.starved = starved_;
  show_master();
  return sample_;
}

Sample Follower::step(std::uint64_t visible) noexcept {
  sample_.passed = 0;
  sample_.passed_at = 0.0;
  take_entries(visible);
  if (!in_span_) start();
  if (stopping_ && at_rest()) drop();
  if (on_course_) {
    follow_course();
    if (!in_span_) pass_markers();
  } else if (in_span_ && by_master_) {
    follow_master();
    if (!in_span_) pass_markers();
  } else if (in_span_) {
    motion_.obey(front(), wish());
    if (motion_.advance(config_.period_s)) leave();
    if (!in_span_) pass_markers();
  } else if (open_ && !wait_stop_ && !wait_event_ && !wants_rest()) {
    ++starved_;
  }
  return sample();
}

}  // namespace servogate::path
