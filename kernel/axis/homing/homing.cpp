// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/homing/homing.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/axis/alarms/axis_alarms.hpp"

namespace servogate::axis {

void Homing::configure(const HomingData& data, const MotionLimits& limits) noexcept {
  data_ = data;
  limits_ = limits;
  state_ = State::idle;
}

void Homing::start(const Ramp& ramp, const HomingInputs& in) noexcept {
  failure_ = 0;
  failure_limit_ = failure_value_ = 0.0;
  elapsed_s_ = 0.0;
  seen_on_ = in.home_switch;
  limit_met_ = stopping_ = reference_pending_ = false;
  moving_ = 0;
  edge_.reset();
  missed_edge_ = false;
  begin_x_ = ramp.state().x;
  armed_sequence_ = in.latch_sequence;
  edge_counts_ = captured_ = in.counts;
  if (data_.method == HomingMethod::none || (data_.method == HomingMethod::absolute && in.referenced)) {
    state_ = State::done;
    return;
  }
  if (data_.method == HomingMethod::absolute) {
    state_ = State::failed;
    failure_ = alarm::kHomingNoReference;
    return;
  }
  if (data_.method == HomingMethod::drive) {
    state_ = State::drive_led;
    return drive_.start();
  }
  if (data_.method == HomingMethod::index_only)
    state_ = State::index;
  else if (!in.home_switch)
    state_ = State::search;
  else
    state_ = data_.release_direction == data_.direction ? State::back_off : State::leave;
}

void Homing::enter(State s, Ramp& ramp) noexcept {
  state_ = s;
  stopping_ = false;
  moving_ = 0;
  begin_x_ = ramp.state().x;
}

void Homing::fail(image::AlarmNumber number, double limit, double value, Ramp& ramp) noexcept {
  failure_ = number;
  failure_limit_ = limit;
  failure_value_ = value;
  state_ = State::failed;
  drive_.stop();
  ramp.stop(limits_);
}

void Homing::abort(Ramp& ramp) noexcept {
  if (active()) state_ = State::idle;
  drive_.stop();
  ramp.stop(limits_);
}

void Homing::drop() noexcept {
  if (active()) state_ = State::idle;
  drive_.drop();
}

bool Homing::take_reference() noexcept {
  const bool pending = reference_pending_;
  reference_pending_ = false;
  return pending;
}

/// Stops the present move; true once it stands and the feedback has caught up.
bool Homing::stop_first(Ramp& ramp, const HomingInputs& in) noexcept {
  if (!stopping_) {
    stopping_ = true;
    ramp.stop(limits_);
    return false;
  }
  return ramp.done() && in.settled;
}

bool Homing::limit_ahead(int direction, const HomingInputs& in) noexcept {
  return direction > 0 ? in.limit_plus : direction < 0 && in.limit_minus;
}

void Homing::run(int direction, double speed, Ramp& ramp) noexcept {
  moving_ = direction;
  MotionLimits lim = limits_;
  lim.velocity = std::min(lim.velocity, speed);
  ramp.move_at(direction * speed, lim);
}

bool Homing::travel_exceeded(Ramp& ramp, double limit, image::AlarmNumber number) noexcept {
  const double way = std::abs(ramp.state().x - begin_x_);
  if (way <= limit) return false;
  fail(number, limit, way, ramp);
  return true;
}

/// The fast search stands: from which side is the decisive edge to be crossed, and where do we stand?
void Homing::after_switch_search(Ramp& ramp, const HomingInputs& in) noexcept {
  const bool drive_on = data_.release_direction == data_.direction;
  const bool past_it = state_ == State::search ? true : in.home_switch;
  seen_on_ = in.home_switch;
  if (drive_on)
    enter(past_it ? State::back_off : State::approach, ramp);
  else
    enter(past_it ? State::leave : State::approach, ramp);
}

void Homing::decisive_edge(Ramp& ramp, const HomingInputs& in) noexcept {
  edge_counts_ = captured_ = in.counts;
  armed_sequence_ = in.latch_sequence;
  edge_.decide(in.home_switch, in.now_ns);
  if (data_.method == HomingMethod::switch_only) {
    enter(State::settle, ramp);
  } else {
    const int keep = moving_;
    enter(State::index, ramp);
    moving_ = keep;
  }
}

/// By now its edge has come, if one comes at all.
void Homing::meet_edge() noexcept {
  if (!data_.edges) return;
  const auto met = edge_.counts();
  missed_edge_ = !met;
  if (met) edge_counts_ = *met;
}

void Homing::step(Ramp& ramp, const HomingInputs& in) noexcept {
  if (!active()) return;
  elapsed_s_ += in.dt;
  if (elapsed_s_ > data_.timeout_s) return fail(alarm::kHomingTimeout, data_.timeout_s, elapsed_s_, ramp);
  if (limit_ahead(moving_, in) && !stopping_ && state_ != State::search)
    return fail(alarm::kHomingLimitAgain, 0.0, ramp.state().x, ramp);
  switch (state_) {
    case State::search:
    case State::reversed:
      return search(ramp, in);
    case State::back_off:
      return back_off(ramp, in);
    case State::approach:
      return approach(ramp, in);
    case State::leave:
      return leave(ramp, in);
    case State::index:
      return index(ramp, in);
    case State::drive_led:
      return drive_led(ramp, in);
    case State::settle:
      if (!stop_first(ramp, in)) return;
      if (data_.method == HomingMethod::switch_only) {
        meet_edge();
        captured_ = edge_counts_;
      }
      reference_pending_ = true;
      return enter(State::final_move, ramp);
    case State::final_move:
      return final_move(ramp, in);
    default:
      return;
  }
}

void Homing::search(Ramp& ramp, const HomingInputs& in) noexcept {
  const bool first = state_ == State::search;
  const int direction = first ? data_.direction : -data_.direction;
  if (stopping_) {
    if (!stop_first(ramp, in)) return;
    if (first && limit_met_) return enter(State::reversed, ramp);
    return after_switch_search(ramp, in);
  }
  if (in.home_switch || limit_ahead(direction, in)) {
    limit_met_ = !in.home_switch;
    stop_first(ramp, in);
  } else if (!travel_exceeded(ramp, data_.max_travel, alarm::kHomingSwitchNotFound)) {
    run(direction, data_.fast, ramp);
  }
}

void Homing::back_off(Ramp& ramp, const HomingInputs& in) noexcept {
  seen_on_ = seen_on_ || in.home_switch;
  if (stopping_) {
    if (!stop_first(ramp, in)) return;
    if (in.home_switch)
      stopping_ = false;  // it bounced, or released only for a moment: further off
    else
      enter(State::approach, ramp);
  } else if (seen_on_ && !in.home_switch) {
    stop_first(ramp, in);
  } else if (!travel_exceeded(ramp, data_.max_travel, alarm::kHomingSwitchNotReleased)) {
    run(-data_.direction, data_.fast, ramp);
  }
}

void Homing::approach(Ramp& ramp, const HomingInputs& in) noexcept {
  if (stopping_) {
    if (!stop_first(ramp, in)) return;
    enter(State::leave, ramp);
    seen_on_ = true;
  } else if (!in.home_switch) {
    if (!travel_exceeded(ramp, data_.max_travel, alarm::kHomingSwitchNotFound))
      run(data_.direction, data_.slow, ramp);
  } else if (data_.release_direction == data_.direction) {
    decisive_edge(ramp, in);
  } else {
    stop_first(ramp, in);
  }
}

void Homing::leave(Ramp& ramp, const HomingInputs& in) noexcept {
  seen_on_ = seen_on_ || in.home_switch;
  if (seen_on_ && !in.home_switch)
    decisive_edge(ramp, in);
  else if (!travel_exceeded(ramp, data_.max_travel, alarm::kHomingSwitchNotReleased))
    run(data_.release_direction, data_.slow, ramp);
}

void Homing::index(Ramp& ramp, const HomingInputs& in) noexcept {
  if (in.latch_sequence != armed_sequence_) {
    captured_ = in.latch_counts;
    if (data_.method == HomingMethod::switch_and_index) meet_edge();
    enter(State::settle, ramp);
    stop_first(ramp, in);
  } else if (!travel_exceeded(ramp, data_.max_index_travel, alarm::kHomingIndexNotFound)) {
    const bool only = data_.method == HomingMethod::index_only;
    run(only ? data_.direction : data_.release_direction, data_.slow, ramp);
  }
}

/// The alarm comes while the drive is still being halted, the reference when the axis leads again.
void Homing::drive_led(Ramp& ramp, const HomingInputs& in) noexcept {
  using Outcome = DriveLedHoming::Outcome;
  drive_.step(data_, in.drive);
  switch (drive_.outcome()) {
    case Outcome::none:
      return;
    case Outcome::attained:
      if (drive_.leads()) return;
      captured_ = in.home_counts;
      reference_pending_ = true;
      return enter(State::final_move, ramp);
    case Outcome::interrupted:
      return fail(alarm::kHomingInterrupted, 0.0, ramp.state().x, ramp);
    case Outcome::failed:
      return fail(alarm::kHomingDriveFailed, 0.0, ramp.state().x, ramp);
    case Outcome::limit:
      return fail(alarm::kHomingLimitAgain, 0.0, ramp.state().x, ramp);
    case Outcome::mode_refused:
      return fail(alarm::kHomingModeRefused, DriveLedHoming::kModePatience, ramp.state().x, ramp);
  }
}

void Homing::final_move(Ramp& ramp, const HomingInputs& in) noexcept {
  if (data_.final_move) {
    MotionLimits lim = limits_;
    lim.velocity = std::min(lim.velocity, data_.fast);
    ramp.move_to(data_.final_position, lim);
    if (!ramp.done() || !in.settled) return;
  }
  state_ = State::done;
}

}  // namespace servogate::axis
