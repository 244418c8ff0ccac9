// SPDX-License-Identifier: Apache-2.0
// A tap among the motions by the spindle's angle: its legs, and the spindle that turns round between them.
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/law/master_motion.hpp"

namespace servogate::path {
namespace {

constexpr double kSpindleHears = 1.0;  // cycles besides what a reading takes, until it has its order
constexpr double kTurnsBack = 0.05;    // of the speed that it was begun with
constexpr double kTurnPatience = 3.0;  // s, besides twice the ramp: a drive that stood so long comes on again

}  // namespace

bool MasterMotion::gather_legs(const Ahead& ahead) noexcept {
  legs_count_ = 0;
  ends_ = true;
  depth_ = 0.0;
  double at = 0.0, sense = 1.0;
  for (int n = 0;; ++n) {
    const Span* span = ahead.span(n);
    if (span == nullptr || n == kMostLegs) return false;
    const Lock& lock = span->terms.feed.lock;
    if (lock.kind == Lock::Kind::none || lock.kind == Lock::Kind::thread) return false;
    const Box& box = span->terms.box;
    box_.velocity = std::min(box_.velocity, box.velocity);
    box_.acceleration = std::min(box_.acceleration, box.acceleration);
    box_.jerk = std::min(box_.jerk, box.jerk);
    legs_[static_cast<std::size_t>(legs_count_++)] = {span->length, lock.per_turn, box.velocity,
                                                      lock.dwell,   lock.turn_rpm, lock.turn};
    at += sense * span->length;
    sense = -sense;
    depth_ = std::max(depth_, at);
    if (lock.kind == Lock::Kind::tap_out) return true;
  }
}

/// The leg in motion as the only segment of the run.
void MasterMotion::begin_leg() noexcept {
  const Leg& leg = legs_[static_cast<std::size_t>(leg_)];
  Segment& segment = segments_[0];
  segment = {};
  segment.per_turn = segment.most = leg.per_turn;
  segment.velocity = leg.velocity;
  segment.length = length_ = leg.length;
  segment.turns = 0.0;
  count_ = 1;
}

void MasterMotion::begin_turn(Turn turn, double w) noexcept {
  turn_ = turn;
  turn_s_ = stood_s_ = 0.0;
  turn_w_ = std::abs(w);
  if (turn != Turn::turning) return;
  asked_turn_ = legs_[static_cast<std::size_t>(leg_)].turn;
  asked_rpm_ = legs_[static_cast<std::size_t>(leg_)].rpm;
}

/// The spindle turns round, or is stopped, so that it stands at the end of the leg.
void MasterMotion::turn_at_end(double w, const MasterReading& reading) noexcept {
  const Leg& leg = legs_[static_cast<std::size_t>(leg_)];
  switch (turn_) {
    case Turn::none: {
      if (last_leg()) return;
      const double hears =
          static_cast<double>(reading.acts_ns - reading.at_ns) * 1e-9 + kSpindleHears * period_;
      const double stops =
          braking_ > 0.0 ? w * (0.5 * w / braking_ + hears) : std::numeric_limits<double>::infinity();
      if ((length_ - state_.s) / leg.per_turn <= stops)
        begin_turn(leg.dwell > 0.0 ? Turn::stopping : Turn::turning, w);
      return;
    }
    case Turn::stopping:
      if (std::abs(w) < kMasterStands) begin_turn(Turn::standing, 0.0);
      return;
    case Turn::standing:
      stood_s_ += period_;
      if (stood_s_ >= leg.dwell) begin_turn(Turn::turning, 0.0);
      return;
    case Turn::turning:
      if (w < 0.0 && state_.v < 0.0) turn_back();
      return;
    case Turn::halting:
      return;
  }
}

/// A spindle that does not do what it is told to does not keep the tap for ever.
void MasterMotion::watch_turn(double w, const MasterReading& reading) noexcept {
  const bool stands_on_its_way = turn_ == Turn::none && std::abs(w) < kMasterStands;
  const bool owes = turn_ == Turn::stopping || turn_ == Turn::turning || turn_ == Turn::halting;
  turn_s_ = owes || stands_on_its_way ? turn_s_ + period_ : 0.0;
  const double patience = kTurnPatience + (reading.braking > 0.0 ? 2.0 * turn_w_ / reading.braking : 0.0);
  if (turn_s_ > patience) fail(MasterFault::no_turn, turn_s_, patience);
}

/// A tap goes with a spindle that slows down and waits with one that stands (watch_turn()); of one that has
/// just come to rest the estimate says for a while that it turns back.
double MasterMotion::least_of_tap() const noexcept {
  return -kMasterStands - kTurnsBack * begun_with_ - 1.5 * braking_ / MasterEstimate::kForgets;
}

/// Where it would rest if it were given up now.
void MasterMotion::watch_depth() noexcept {
  if ((leg_ == 0 || halt_) && state_.s < -tap_overshoot_) fail(MasterFault::reversed, state_.v, 0.0);
  if (state_.v <= 0.0 || (last_leg() && !halt_)) return;
  // One cycle passes before it slows down.
  const double beyond =
      state_.s + state_.v * period_ + ramp_distance(state_.v, state_.a, 0.0, box_) - length_;
  if (beyond > tap_overshoot_) fail(MasterFault::overshoot, beyond, tap_overshoot_);
}

void MasterMotion::tap(const MasterState& now, const MasterReading& reading) noexcept {
  const double w = direction_ * now.w;
  deepest_ = std::max(deepest_, leg_begin_ + sense_ * state_.s);
  if (halt_ && turn_ != Turn::halting) begin_turn(Turn::halting, w);
  turn_at_end(w, reading);
  watch_turn(direction_ * now.w, reading);
  if (phase_ == Phase::locked) watch_depth();
  if (phase_ == Phase::locked && halt_ && std::abs(now.w) < kMasterStands) give_up();
}

/// From here on the next leg counts, which leads back from where this one was to end.
void MasterMotion::turn_back() noexcept {
  state_ = {length_ - state_.s, -state_.v, -state_.a};
  whole_ = -whole_ - length_ / segments_[0].per_turn;
  direction_ = -direction_;
  leg_begin_ += sense_ * length_;
  sense_ = -sense_;
  remembered_ = 0;
  ++leg_;
  begin_leg();
  begin_turn(Turn::none, 0.0);
}

/// How a motion that is given up slows down. A tap whose angle is lost does as its spindle is told to: there
/// is nothing else to go by.
Box MasterMotion::leaving_box(const MotionState& from) const noexcept {
  Box box = box_;
  if (!taps() || fault_ != MasterFault::lost || !(braking_ > 0.0)) return box;
  box.acceleration = std::min(box.acceleration, braking_ * segments_[0].per_turn);
  const double rest = from.s + ramp_distance(from.v, from.a, 0.0, box);
  return rest > length_ + tap_overshoot_ ? box_ : box;
}

}  // namespace servogate::path
