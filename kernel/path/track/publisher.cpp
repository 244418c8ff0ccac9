// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/track/publisher.hpp"

#include <algorithm>

namespace servogate::path {
namespace {

// s, to the last stop that is known; no change of rate takes longer.
constexpr double kPlannedAhead = 9.6;
// The knot at the end of the interval in motion is so far behind those that are given back.
constexpr std::uint64_t kKnotsKept = 8;

}  // namespace

void Publisher::put(const Span& span) {
  Entry& entry = entries_.emplace_back();
  entry.kind = Entry::Kind::span;
  entry.span = span;
  entry.planned = final_time_ = std::max(final_time_, span.time);
}

void Publisher::begin_course() {
  course_ = {};
  course_.kind = Entry::Kind::course;
  course_.span.first_piece = next().piece;
  course_.first_knot = next().knot;
  course_.first_stop = next().stop;
  course_begins_ = final_time_;
  entries_.push_back(course_);
}

void Publisher::put(const Knot& knot) {
  knots_.push_back(knot);
  knots_.back().planned = course_begins_ + knot.t.since({});
}

void Publisher::extend(const CourseExtent& extent) {
  course_.kind = Entry::Kind::extend;
  course_.extent = extent;
  course_.planned = final_time_ = course_begins_ + extent.seconds;
  entries_.push_back(course_);
}

Track::Begin Publisher::next() const {
  return {track_.entries.written() + entries_.size(), track_.pieces.written() + pieces_.size(),
          track_.knots.written() + knots_.size(), track_.stops.written() + stops_.size()};
}

/// What the entry speaks of can be read.
bool Publisher::in_track(const Entry& entry) const {
  if (entry.kind == Entry::Kind::span)
    return entry.span.first_piece + entry.span.pieces <= track_.pieces.written();
  return entry.kind != Entry::Kind::extend ||
         (entry.span.first_piece + entry.extent.pieces <= track_.pieces.written() &&
          entry.first_knot + entry.extent.knots <= track_.knots.written() &&
          entry.first_stop + entry.extent.stops <= track_.stops.written());
}

void Publisher::work() {
  while (!pieces_.empty() && track_.pieces.push(pieces_.front())) pieces_.pop_front();
  while (!knots_.empty() && track_.knots.push(knots_.front())) knots_.pop_front();
  while (!stops_.empty() && track_.stops.push(stops_.front())) stops_.pop_front();
  while (!entries_.empty() && in_track(entries_.front()) && track_.entries.push(entries_.front())) {
    shown_time_ = std::max(shown_time_, entries_.front().planned);
    entries_.pop_front();
  }
}

std::optional<double> Publisher::passed() const {
  const std::uint64_t piece = track_.pieces.given_back(), knot = track_.knots.given_back();
  if (piece >= track_.pieces.written()) return std::nullopt;
  if (knot >= track_.knots.written()) return track_.pieces[piece].time;
  return track_.knots[std::min(knot + kKnotsKept, track_.knots.written() - 1)].planned;
}

bool Publisher::wants_more() const {
  if (waits()) return false;
  const std::optional<double> from = passed();
  return !from || final_time_ - *from < kPlannedAhead;
}

double Publisher::ahead(std::optional<double> driven) const {
  const std::optional<double> from = driven ? driven : passed();
  return from ? std::max(0.0, shown_time_ - *from) : 0.0;
}

}  // namespace servogate::path
