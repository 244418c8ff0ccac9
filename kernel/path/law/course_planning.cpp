// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/course_planning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace servogate::path {
namespace {

constexpr double kWayOfStop = 0.7, kReach = 1.5;  // law time of a stop by its length; so much longer may fit
constexpr std::int64_t kAgain = 24;               // knots until one that did not fit is looked for again

Pipeline::Settings settings(const Config& config) {
  Pipeline::Settings s;
  s.axes = config.axis_count;
  s.reserve = config.reserve;
  s.transformation = config.transformation;
  return s;
}

}  // namespace

CoursePlanning::CoursePlanning(const Config& config, CourseSink& sink)
    : config_(config), sink_(sink), pipeline_(settings(config), *this) {
  limits_.axes = config.axis_count;
  limits_.limits = config.limits;
  limits_.transformation = config.transformation;
}

void CoursePlanning::restart() {
  pipeline_.abandon();
  view_ = {};
  extent_ = {};
  pieces_.clear();
  begun_ = joins_ = broken_ = false;
  confirm_.reset();
  cruises_.clear();
}

bool CoursePlanning::work() {
  if (broken_) return false;
  const bool worked = pipeline_.work();
  look_for_break();
  return worked;
}

/// The motion stops where the last stop that is known leads to.
void CoursePlanning::look_for_break() {
  if (broken_ || !begun_ || !pipeline_.broken()) return;
  broken_ = extent_.broken = true;
  rest_ = {sure_, std::nullopt};
  if (extent_.stops > 0) {
    const RateChange stop{1.0, 0.0, 0.0, stop_.seconds, stop_.power};
    extent_.rest = view_.knot(stop_.knot)->t.plus(stop.at(stop_.seconds).passed);
    extent_.seconds += stop_.seconds;
    const CoursePoint at =
        point_at(view_, extent_.rest, std::max<std::int64_t>(1, stop_.knot), {limits_.axes, {}});
    rest_ = {at.place, at.x};
  }
  sink_.extend(extent_);
}

void CoursePlanning::place(Leg leg) {
  if (!begun_) {
    sink_.begin_course();
    view_ = {};
    extent_ = {};
    base_ = {};
    length_ = section_ = 0.0;
    given_ = 0;
    given_until_ = 0.0;
    looked_ = look_at_ = 0;
    stop_ = {};
    sure_ = 0.0;
    begun_ = true;
  }
  leg.piece.start = length_;
  length_ += leg.piece.length;
  pieces_.push_back(leg.piece);
}

void CoursePlanning::put(const Leg& leg) {
  if (broken_) return;
  place(leg);
  pipeline_.add(leg);
}

void CoursePlanning::cruise(const Leg& leg, double speed) {
  if (broken_) return;
  const double behind = length_;
  place(leg);
  cruises_.push_back({behind, length_});
  pipeline_.cruise(leg, speed);
}

void CoursePlanning::rest(bool confirm) {
  if (!begun_ || broken_) return;
  confirm_ = confirm;
  pipeline_.end();
}

/// All knots of the course are here.
void CoursePlanning::rest() {
  look_for_break();
  if (broken_) return;
  view_.complete = true;
  find_stops();
  const Knot& last = *view_.knot(view_.last());
  extent_.complete = true;
  extent_.confirm = *std::exchange(confirm_, std::nullopt);
  extent_.seconds = last.t.since({});
  give();
  begun_ = joins_ = false;
}

void CoursePlanning::begin(const Vector& before_last, const Vector& last) {
  for (const Vector& control : {before_last, last}) {
    Knot guide;
    guide.kind = Knot::Kind::guide;
    guide.t = base_;
    guide.control = control;
    guide.place = section_;
    append(guide);
  }
}

void CoursePlanning::put(const Knot& knot) {
  Knot next = knot;
  next.t = base_.plus(knot.t);
  next.place += section_;
  if (joins_) next.kind = Knot::Kind::join;
  joins_ = false;
  append(next);
}

void CoursePlanning::cruise(const Cruise& cruise) {
  look_for_break();
  if (broken_) return;
  const Span way = cruises_.front();
  cruises_.pop_front();
  const Knot before = *view_.knot(view_.last());
  if (cruise.piece.shape == Piece::Shape::arc)
    arc(cruise, before);
  else
    straight(cruise, before, way.end - way.begin);
  joins_ = true;
  section_ = way.end;
}

void CoursePlanning::straight(const Cruise& cruise, const Knot& before, double length) {
  Knot straight;
  straight.kind = Knot::Kind::straight;
  straight.t = base_ = before.t.plus(cruise.seconds);
  straight.place = before.place + length;
  straight.control = position(cruise.piece, cruise.piece.length, config_.axis_count);
  straight.turns = before.turns;
  append(straight);
}

/// An arc at constant speed needs no law, and knots only as dense as its spline is the arc.
void CoursePlanning::arc(const Cruise& cruise, const Knot& before) {
  constexpr double kTurn = 0.05, kSeconds = 0.032;  // between two knots, at most
  const Piece& piece = cruise.piece;
  const double turn = std::abs(piece.omega) * piece.length;
  const double count = std::ceil(std::max(turn / kTurn, cruise.seconds / kSeconds));
  const double seconds = cruise.seconds / count, spacing = piece.length / count;
  const auto control = [&](double k) {
    return spline_control(piece, k * spacing, spacing, config_.axis_count);
  };
  base_ = before.t;
  section_ = before.place;
  begin(control(-1.0), control(0.0));
  joins_ = true;
  for (double k = 0.0; k <= count; ++k) {
    Knot knot;
    knot.t = LawTime{}.plus(k * seconds);
    knot.w = 1.0 / seconds;
    knot.place = k * spacing;
    knot.turns = before.turns;
    knot.control = control(k + 1.0);
    put(knot);
  }
  base_ = view_.knot(view_.last())->t;
}

void CoursePlanning::append(const Knot& knot) {
  if (broken_) return;
  view_.knots.push_back(knot);
  find_stops();
}

void CoursePlanning::find_stops() {
  while (looked_ <= view_.last() && (view_.complete || view_.last() >= look_at_)) {
    const Knot& at = *view_.knot(looked_);
    const Knot& last = *view_.knot(view_.last());
    if (at.kind == Knot::Kind::guide || at.kind == Knot::Kind::join) {
      ++looked_;
      continue;
    }
    const double known = last.t.since(at.t);
    if (!view_.complete && known < kReach * kWayOfStop * stop_.seconds) return;
    const StopHint found = find_stop(view_, looked_, stop_, limits_);
    if (found.knot < 0 && !view_.complete) {
      look_at_ = view_.last() + kAgain;
      return;
    }
    if (found.knot >= 0) {
      stop_ = found;
      sure_ = at.place;
      extent_.seconds = at.t.since({});
      ++extent_.stops;
      sink_.put(found);
      give();
    }
    looked_ += kStopEvery;
  }
}

/// Up to a knot. Where the program has far more of them than cycles can tell apart, several become one: the
/// track has room for so many.
void CoursePlanning::give_pieces(const Knot& to) {
  constexpr double kUsual = 256.0, kPerSecond = 8000.0, kMost = 2048.0;
  const double seconds = to.t.since({});
  const double most = std::min(kMost, kUsual + kPerSecond * (seconds - given_until_));
  given_until_ = seconds;
  const auto end = extent_.complete ? pieces_.end()
                                    : std::find_if(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
                                        return piece.start > to.place;
                                      });
  const auto count = static_cast<std::size_t>(end - pieces_.begin());
  const auto together = static_cast<std::size_t>(std::ceil(static_cast<double>(count) / most));
  for (std::size_t n = 0; n < count; n += together, ++extent_.pieces) {
    const std::size_t last = std::min(count, n + together) - 1;
    sink_.put(last == n ? pieces_[n] : joined(pieces_[n], pieces_[last], config_.axis_count));
  }
  pieces_.erase(pieces_.begin(), end);
}

void CoursePlanning::give() {
  for (; given_ < view_.knots.end(); ++given_) sink_.put(view_.knots[given_]);
  extent_.knots = given_;
  give_pieces(*view_.knot(view_.last()));
  const std::int64_t needed = std::min(looked_, std::max<std::int64_t>(0, stop_.knot)) - 4;
  view_.knots.forget_before(static_cast<std::size_t>(std::max<std::int64_t>(0, needed)));
  sink_.extend(extent_);
}

}  // namespace servogate::path
