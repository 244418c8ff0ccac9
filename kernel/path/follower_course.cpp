// SPDX-License-Identifier: Apache-2.0
// How the follower is on a course.
#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/path/follower.hpp"

namespace servogate::path {
namespace {

constexpr double kKnownAtStart = 0.5;   // s of a course
constexpr double kSameRate = 5e-4;      // of a rate: the spindle's speed is no other than it was
constexpr double kSpindleAhead = 0.04;  // s
constexpr double kSpindleJump = 0.2;    // of its speed, in that time: no ramp

}  // namespace

/// Share of the speed that a course is planned for where it is in motion, or begins, by the spindle alone.
double Follower::course_share() const noexcept {
  if (spindle_ < 0.0 || window_.course() == nullptr) return 1.0;
  CourseAhead course(track_);
  course.take(*window_.course());
  const std::int64_t m = on_course_ ? rate_.knot() : 0;
  const Knot *to = course.knot(m), *from = on_course_ ? course.knot(begin_of(course, m)) : to;
  if (to == nullptr || from == nullptr || to->turns == 0.0) return 1.0;
  const double way = to->t.since(from->t), gone = rate_.time().since(from->t);
  const double z = on_course_ && way > 0.0 ? std::clamp(gone / way, 0.0, 1.0) : 1.0;
  return spindle_ / (from->turns > 0.0 ? from->turns + z * (to->turns - from->turns) : to->turns);
}

std::optional<double> Follower::driven() const noexcept {
  if (!in_span_) return std::nullopt;
  if (!on_course_)
    return by_master_ ? front().time
                      : front().time - (front().length - motion_.state().s) / front().terms.box.velocity;
  const Knot* knot = course_.knot(rate_.knot());
  if (knot == nullptr) return std::nullopt;
  return knot->planned + rate_.time().since(knot->t);
}

/// A change of rate takes some cycles, and leads to the speed that the spindle has then; the next one follows
/// behind it.
double Follower::rate_wanted() noexcept {
  const bool same = asked_override_ == override_;
  asked_override_ = override_;
  const double share = course_share(), now = rate_.wanted();
  double rise = (share - std::exchange(share_, share)) / config_.period_s * kSpindleAhead;
  if (wants_rest()) return 0.0;
  if (share == 1.0) return override_;
  if (rate_.underway() && now > 0.0 && same) return now;
  if (std::abs(rise) > kSpindleJump * share) rise = 0.0;
  const double rate = std::min((share + rise) * override_, config_.largest_override);
  return std::abs(rate - now) < kSameRate * rate ? now : rate;
}

/// Not before some of it is known, or all.
void Follower::begin_course(const Entry& course) noexcept {
  course_.take(course);
  const Knot* guard = course_.knot(course_.guard().knot);
  const bool enough = course_.guard().knot >= 0 && guard != nullptr && guard->t.since({}) >= kKnownAtStart;
  if (!course.extent.complete && !course.extent.broken && !enough) return;
  in_span_ = open_ = on_course_ = true;
  piece_ = course.span.first_piece;
  rate_.begin(1.0);
  share_ = course_share();
  rate_.begin(std::min(rate_wanted(), 1.0));
}

void Follower::follow_course() noexcept {
  const bool goes_on = rate_.step(course_, rate_wanted(), config_.period_s);
  if (rate_.starving() && !rest_asked() && !course_.extent().broken) ++starved_;
  if (!goes_on) return course_.extent().broken ? leave_broken_course() : leave_course();
  // Should it break, a hold that has gone further comes back to where its last stop leads to.
  const std::int64_t needed = std::min(rate_.knot(), std::max<std::int64_t>(0, course_.guard().knot));
  track_.knots.free_below(course_.knots_behind(course_.extent().complete ? rate_.knot() : needed));
  track_.stops.free_below(course_.stops_behind(rate_.knot()));
}

void Follower::leave_course() noexcept {
  const bool waits = course_.extent().confirm;
  window_.pop();
  arrive(track_.pieces[course_.behind().piece - 1], waits);
  free_course();
}

/// The path goes on from the place where it rests.
void Follower::leave_broken_course() noexcept {
  if (on_course_) sample_.position = rate_.point(course_).x;
  course_.take(window_.front());
  window_.pop();
  in_span_ = on_course_ = false;
  motion_.rest();
  free_course();
}

void Follower::free_course() noexcept {
  const Track::Begin behind = course_.behind();
  track_.pieces.free_below(behind.piece);
  track_.knots.free_below(behind.knot);
  track_.stops.free_below(behind.stop);
}

void Follower::drop_course(const Entry& known) noexcept {
  course_.take(known);
  begun_ = course_.behind().piece;
  free_course();
}

}  // namespace servogate::path
