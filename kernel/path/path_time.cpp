// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/path_time.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/s_curve.hpp"

namespace servogate::path {

PathTime::PathTime(const Config& config, const Vector& start)
    : config_(config), track_(config), planner_(config, track_) {
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

void PathTime::take_entries() {
  for (planner_.work(); taken_ < track_.entries.written(); planner_.work()) {
    for (; taken_ < track_.entries.written(); track_.entries.free_below(++taken_)) {
      const Entry& entry = track_.entries[taken_];
      if (entry.kind == Entry::Kind::span) spans_.push_back(entry.span);
      if (entry.kind != Entry::Kind::raise || spans_.empty() || entry.span.number < spans_.front().number)
        continue;
      // Numbers of spans run without a gap.
      spans_[static_cast<std::size_t>(entry.span.number - spans_.front().number)] = entry.span;
    }
    track_.pieces.free_below(track_.pieces.written());
  }
  time_spans();
}

void PathTime::time_spans() {
  while (!spans_.empty() && spans_.front().final && (spans_.front().stop || spans_.size() > 1)) {
    const Span span = spans_.front();
    spans_.pop_front();
    way_ += time_span(span, span.stop ? nullptr : &spans_.front());
    if (!span.stop) continue;
    seconds_ += std::ceil(way_ / config_.period_s - 1e-6) * config_.period_s;
    way_ = speed_ = 0.0;
  }
}

// As Follower::goal() at override 1, with the spindle turning as planned.
double PathTime::time_span(const Span& span, const Span* behind) {
  Goal goal;
  goal.length = span.length;
  goal.exit_limit = span.exit_limit;
  goal.velocity = std::min(span.box.velocity, span.feed);
  goal.exit = std::min(span.exit_nominal, goal.velocity);
  if (behind != nullptr) goal.exit = std::min(goal.exit, behind->feed);
  const MotionState from{0.0, speed_, 0.0};
  Profile profile;
  profile.start(from);
  if (!plan(profile, from, goal, span.box)) {
    goal.exit_limit = goal.exit = goal.velocity = span.box.velocity;
    if (!plan(profile, from, goal, span.box)) return span.length / std::max(goal.velocity, 1e-9);
  }
  speed_ = profile.end().v;
  return profile.duration();
}

}  // namespace servogate::path
