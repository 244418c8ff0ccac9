// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/path_time.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kMoment = 0.004, kMoments = 16.0;  // s along a span, and of them in a span at least
constexpr double kReached = 0.6;                    // of a limit: it is what binds

}  // namespace

PathTime::PathTime(const Config& config, const Vector& start, MomentSink* look)
    : config_(config), look_(look), track_(config_), planner_(config_, track_, this) {
  planner_.restart(start);
}

bool PathTime::add(const Element& element) {
  if (!planner_.add(element)) return false;
  take_entries();
  return true;
}

void PathTime::rest() {
  planner_.finish();
  take_entries();
}

void PathTime::put(const Moment& moment) {
  if (look_ != nullptr) moments_.push_back(moment);
}

void PathTime::take_entries() {
  for (planner_.work(); taken_ < track_.entries.written(); planner_.work()) {
    take_pieces();
    for (; taken_ < track_.entries.written(); track_.entries.free_below(++taken_)) {
      const Entry& entry = track_.entries[taken_];
      if (entry.kind == Entry::Kind::span) spans_.push_back(entry.span);
      on_course_ = on_course_ || entry.kind == Entry::Kind::course;
      if (entry.kind == Entry::Kind::extend) {  // from rest to rest: all spans before it are final
        time_spans();
        look_along_course();
        on_course_ = false;
        seconds_ += whole_cycles(entry.extent.seconds);
        continue;
      }
      if (entry.kind != Entry::Kind::revise || spans_.empty() || entry.span.number < spans_.front().number)
        continue;
      // Numbers of spans run without a gap.
      spans_[static_cast<std::size_t>(entry.span.number - spans_.front().number)] = entry.span;
    }
  }
  time_spans();
  if (on_course_) look_along_course();
}

void PathTime::take_pieces() {
  if (look_ != nullptr) {
    if (pieces_.empty()) first_piece_ = track_.pieces.given_back();
    for (std::uint64_t n = track_.pieces.given_back(); n < track_.pieces.written(); ++n)
      pieces_.push_back(track_.pieces[n]);
  }
  track_.pieces.free_below(track_.pieces.written());
}

double PathTime::whole_cycles(double seconds) const {
  return std::ceil(seconds / config_.period_s - 1e-6) * config_.period_s;
}

void PathTime::time_spans() {
  while (!spans_.empty() && spans_.front().final && (spans_.front().stop || spans_.size() > 1)) {
    const Span span = spans_.front();
    spans_.pop_front();
    if (look_ != nullptr && way_ == 0.0) look_->put({0.0, 0.0, Brake::rest, -1, command_of(span)});
    way_ += timing_.through(span, span.stop ? nullptr : &spans_.front());
    if (look_ != nullptr) look_along(span);
    if (!span.stop) continue;
    seconds_ += whole_cycles(way_);
    way_ = 0.0;
  }
}

/// The course that the track speaks of, up to its rest or as far as it is foretold.
void PathTime::look_along_course() {
  while (!moments_.empty()) {
    const Moment next = moments_.front();
    moments_.pop_front();
    look_->put(next);
    if (next.seconds > 0.0) continue;
    course_begun_ = !course_begun_;
    if (!course_begun_) return;
  }
}

Moment PathTime::moment(const Piece& piece, const MotionState& state, double jerk) const {
  Moment found;
  found.feed = state.v;
  found.command = piece.tag.command;
  PathPoint at = evaluate(piece, std::clamp(state.s - piece.start, 0.0, piece.length), config_.axis_count);
  config_.transformation->to_axes(at, config_.axis_count);
  double most = kReached;
  for (int i = 0; i < config_.axis_count; ++i) {
    const AxisLimits& limits = config_.limits[static_cast<std::size_t>(i)];
    const auto look_at = [&](Brake brake, double share) {
      if (share <= most) return;
      most = share;
      found.brake = brake;
      found.axis = i;
    };
    const double d1 = at.d1[i], d2 = at.d2[i], v = state.v;
    look_at(Brake::velocity, std::abs(d1 * v) / limits.velocity);
    look_at(Brake::acceleration, std::abs(d1 * state.a + d2 * v * v) / limits.acceleration);
    look_at(Brake::jerk, std::abs(d1 * jerk + 3.0 * d2 * v * state.a + at.d3[i] * v * v * v) / limits.jerk);
  }
  return found;
}

void PathTime::look_along(const Span& span) {
  for (; !pieces_.empty() && first_piece_ < span.first_piece; ++first_piece_) pieces_.pop_front();
  const Profile& way = timing_.profile();
  const double all = way.duration(), count = std::ceil(std::max(kMoments, all / kMoment)), step = all / count;
  std::size_t n = 0;
  for (double k = 0.0; k < count && !pieces_.empty(); ++k) {
    const double t = (k + 0.5) * step;
    const MotionState state = way.at(t);
    while (n + 1 < std::min<std::size_t>(span.pieces, pieces_.size()) && pieces_[n + 1].start <= state.s) ++n;
    Moment next = moment(pieces_[n], state, way.jerk(t));
    next.seconds = step;
    look_->put(next);
  }
  if (span.stop) look_->put({0.0, 0.0, Brake::rest, -1, command_of(span)});
}

/// Of the last element that a span lies on.
std::uint64_t PathTime::command_of(const Span& span) const {
  const std::uint64_t last = span.first_piece + span.pieces - 1 - first_piece_;
  return last < pieces_.size() ? pieces_[static_cast<std::size_t>(last)].tag.command : 0;
}

}  // namespace servogate::path
