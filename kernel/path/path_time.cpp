// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/path_time.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kMoment = 0.004, kMoments = 16.0;  // s along an element, and of them in it at least
constexpr double kReached = 0.6;                    // of a limit: it is what binds

}  // namespace

PathTime::PathTime(const Config& config, const Vector& start, MomentSink* look)
    : config_(config), look_(look), track_(config_), planner_(config_, track_, this) {
  planner_.restart(start);
}

bool PathTime::add(const Element& element) {
  Element free = element;
  free.lock = {};  // no spindle turns here
  if (!planner_.add(free)) return false;
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
  for (planner_.work(); taken_ < track_.entries.written(); planner_.work())
    for (; taken_ < track_.entries.written(); track_.entries.free_below(++taken_))
      take(track_.entries[taken_]);
  if (on_course_) look_along_course();
}

/// Entries end in rest, but for the begin of a course.
void PathTime::take(const Entry& entry) {
  if (entry.kind == Entry::Kind::course) on_course_ = true;
  if (entry.kind == Entry::Kind::extend) {
    look_along_course();
    on_course_ = false;
    seconds_ += whole_cycles(entry.extent.seconds);
  }
  if (entry.kind != Entry::Kind::span) return;
  const Profile way = as_planned(entry.span);
  seconds_ += whole_cycles(way.duration());
  if (look_ != nullptr) look_along(track_.pieces[entry.span.first_piece], way);
  track_.pieces.free_below(entry.span.first_piece + entry.span.pieces);
}

double PathTime::whole_cycles(double seconds) const {
  return std::ceil(seconds / config_.period_s - 1e-6) * config_.period_s;
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
  PathPoint at = evaluate(piece, std::clamp(state.s, 0.0, piece.length), config_.axis_count);
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

void PathTime::look_along(const Piece& piece, const Profile& way) {
  const Moment rest{0.0, 0.0, Brake::rest, -1, piece.tag.command};
  look_->put(rest);
  const double all = way.duration(), count = std::ceil(std::max(kMoments, all / kMoment)), step = all / count;
  for (double k = 0.0; k < count; ++k) {
    const double t = (k + 0.5) * step;
    Moment next = moment(piece, way.at(t), way.jerk(t));
    next.seconds = step;
    look_->put(next);
  }
  look_->put(rest);
}

}  // namespace servogate::path
