// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/guard.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <thread>

namespace servogate::bench {
namespace {

constexpr double kEnableWait_s = 5.0, kStopWait_s = 5.0, kOffWait_s = 2.0;
/// Torque is looked at as a mean over this time: a single value is mostly noise.
constexpr double kTorqueMean_s = 0.02;
/// Speed is looked at over at least this time by the clock of the answers: of two answers it is mostly the
/// grain of the encoder, and cycles that come late or crowded would make a runaway of an even motion.
constexpr double kSpeedMean_s = 0.005;
/// Speeds below it count as rest, rad/s.
constexpr double kRest = 0.05;
constexpr int kOfflineCycles = 10;
/// Overshoot of a speed that was asked for at its limit is no runaway.
constexpr double kSpeedRoom = 1.2, kTorqueRoom = 1.2;

}  // namespace

Guard::Guard(BenchDrive& drive, const Envelope& envelope)
    : drive_(drive), envelope_(envelope), period_(drive.period_s()), stages_{"start"} {}

Guard::~Guard() { release(); }

bool Guard::fail(Trip trip, double value, double limit) {
  if (trip_ == Trip::none) {
    trip_ = trip;
    trip_value_ = value;
    trip_limit_ = limit;
  }
  return false;
}

bool Guard::look_at_set_point(Loop loop, double v) {
  if (!std::isfinite(v)) return fail(Trip::travel, v, 0.0);
  if (loop == Loop::position && (v < envelope_.travel_min_rad || v > envelope_.travel_max_rad))
    return fail(Trip::travel, v, v < 0.0 ? envelope_.travel_min_rad : envelope_.travel_max_rad);
  if (loop == Loop::velocity && std::abs(v) > envelope_.speed_rad_s)
    return fail(Trip::speed, v, envelope_.speed_rad_s);
  if (loop == Loop::torque && std::abs(v) > envelope_.torque_nm)
    return fail(Trip::torque, v, envelope_.torque_nm);
  return true;
}

/// A quick stop that begins there with this speed ends within the travel.
bool Guard::look_at_travel(double position, double speed) {
  const double brakes =
      envelope_.quick_stop_rad_s2 > 0.0 ? 0.5 * speed * speed / envelope_.quick_stop_rad_s2 : 0.0;
  const double end = position + std::copysign(brakes, speed);
  if (end < envelope_.travel_min_rad) return fail(Trip::travel, end, envelope_.travel_min_rad);
  if (end > envelope_.travel_max_rad) return fail(Trip::travel, end, envelope_.travel_max_rad);
  return true;
}

bool Guard::accepts(Loop loop, std::span<const double> set_points) {
  double before = 0.0, position = 0.0;
  for (const double v : set_points) {
    if (!look_at_set_point(loop, v)) return false;
    const double speed = loop == Loop::position ? (v - before) / period_ : v;
    if (loop == Loop::position && std::abs(speed) > envelope_.speed_rad_s)
      return fail(Trip::speed, speed, envelope_.speed_rad_s);
    before = v;
    position = loop == Loop::position ? v : position + v * period_;
    if (loop != Loop::torque && !look_at_travel(position, speed)) return false;
  }
  const double time = static_cast<double>(set_points.size()) * period_;
  return time <= envelope_.time_s || fail(Trip::time, time, envelope_.time_s);
}

bool Guard::accepts_torque(std::span<const double> set_points, const LeastLoad& load) {
  if (!accepts(Loop::torque, set_points)) return false;
  double position = 0.0, speed = 0.0;
  for (const double torque : set_points) {
    const double free = speed + torque / load.inertia_kg_m2 * period_;
    const double held = load.friction_nm / load.inertia_kg_m2 * period_;
    // Dry friction brings to rest and never turns a motion back.
    speed = std::abs(free) <= held ? 0.0 : free - std::copysign(held, free);
    position += speed * period_;
    if (std::abs(speed) > envelope_.speed_rad_s) return fail(Trip::speed, speed, envelope_.speed_rad_s);
    if (!look_at_travel(position, speed)) return false;
  }
  return true;
}

bool Guard::accepts_travel(double from, double to) {
  if (from < envelope_.travel_min_rad) return fail(Trip::travel, from, envelope_.travel_min_rad);
  if (to > envelope_.travel_max_rad) return fail(Trip::travel, to, envelope_.travel_max_rad);
  return true;
}

bool Guard::exchange(const DriveAsk& ask) {
  const double before = answer_.position_rad;
  const bool goes_on = drive_.cycle(ask, answer_);
  time_ += period_;
  ++cycles_since_online_;
  if (answer_.online) {
    speed_ = known_ ? (answer_.position_rad - before) / (cycles_since_online_ * period_) : 0.0;
    cycles_since_online_ = 0;
    known_ = true;
    places_[place_count_++ % places_.size()] = {answer_.time_s, answer_.position_rad};
    mean_torque_ += std::min(1.0, period_ / kTorqueMean_s) * (answer_.torque_nm - mean_torque_);
  }
  samples_.push_back({time_, ask.loop, ask.value, answer_.position_rad, answer_.torque_nm, answer_.statusword,
                      static_cast<std::uint16_t>(stages_.size() - 1)});
  last_loop_ = ask.loop;
  const auto every = static_cast<std::size_t>(std::max(1.0, watch_s / period_));
  if (watch && samples_.size() % every == 0) watch(*this);
  return goes_on;
}

double Guard::even_speed() const {
  const std::size_t kept = std::min(place_count_, places_.size());
  if (kept < 2) return 0.0;
  const Place& now = places_[(place_count_ - 1) % places_.size()];
  Place before = now;
  for (std::size_t back = 1; back < kept && now.time_s - before.time_s < kSpeedMean_s; ++back)
    before = places_[(place_count_ - 1 - back) % places_.size()];
  const double time = now.time_s - before.time_s;
  return time >= kSpeedMean_s ? (now.position_rad - before.position_rad) / time : 0.0;
}

bool Guard::look_at_answer() {
  offline_cycles_ = answer_.online ? 0 : offline_cycles_ + 1;
  if (answer_.faulted) return fail(Trip::fault, answer_.error_code);
  if (offline_cycles_ > kOfflineCycles) return fail(Trip::offline);
  if (!answer_.online) return true;
  if (powered_ && !answer_.enabled) return fail(Trip::not_enabled, answer_.statusword);
  const double speed = even_speed();
  // Where it will be in two cycles: one is lost on the bus in each direction.
  if (!look_at_travel(answer_.position_rad + 2.0 * period_ * speed, speed)) return false;
  if (std::abs(speed) > kSpeedRoom * envelope_.speed_rad_s)
    return fail(Trip::speed, speed, envelope_.speed_rad_s);
  if (std::abs(mean_torque_) > kTorqueRoom * envelope_.torque_nm)
    return fail(Trip::torque, mean_torque_, envelope_.torque_nm);
  return true;
}

bool Guard::look_at_following(Loop loop, double set_point) {
  const double error = set_point - answer_.position_rad;
  if (loop == Loop::position && answer_.online && std::abs(error) > envelope_.following_rad)
    return fail(Trip::following, error, envelope_.following_rad);
  return true;
}

bool Guard::enable(Loop loop) {
  if (trip_ != Trip::none) return false;
  released_ = false;
  for (double t = 0.0; t < kEnableWait_s; t += period_) {
    const double here = loop == Loop::position ? answer_.position_rad : 0.0;
    if (drive_.ended()) return fail(Trip::ended);
    if (!exchange({known_, false, loop, here})) return fail(Trip::gone);
    if (answer_.faulted) return fail(Trip::fault, answer_.error_code);
    if (answer_.enabled) {
      powered_ = true;
      last_position_asked_ = here;
      return look_at_answer() && look_at_following(loop, here);
    }
  }
  return known_ ? fail(Trip::not_enabled, answer_.statusword) : fail(Trip::offline);
}

/// Whether one more cycle with power may be.
bool Guard::ready() {
  if (trip_ != Trip::none) return false;
  if (!powered_) return fail(Trip::not_enabled, answer_.statusword);
  powered_s_ += period_;
  if (powered_s_ > envelope_.time_s) return fail(Trip::time, powered_s_, envelope_.time_s);
  return !drive_.ended() || fail(Trip::ended);
}

bool Guard::step(Loop loop, double set_point) {
  if (!ready() || !look_at_set_point(loop, set_point)) return false;
  const double speed = (set_point - last_position_asked_) / period_;
  if (loop == Loop::position && std::abs(speed) > envelope_.speed_rad_s * (1.0 + 1e-9))
    return fail(Trip::speed, speed, envelope_.speed_rad_s);
  if (!exchange({true, false, loop, set_point})) return fail(Trip::gone);
  last_position_asked_ = loop == Loop::position ? set_point : answer_.position_rad;
  last_speed_asked_ = loop == Loop::velocity ? set_point : 0.0;
  return look_at_answer() && look_at_following(loop, set_point);
}

bool Guard::lead_to(double target) {
  if (!ready() || !look_at_set_point(Loop::position, target)) return false;
  if (!exchange({true, false, Loop::position, target})) return fail(Trip::gone);
  last_position_asked_ = answer_.position_rad;
  last_speed_asked_ = 0.0;
  return look_at_answer();
}

bool Guard::run_at(double speed, double acceleration, double hold_s) {
  // From what it makes, where it was led by torque or position before.
  const double most = envelope_.speed_rad_s;
  const double from =
      last_loop_ == Loop::velocity ? last_speed_asked_ : std::clamp(even_speed(), -most, most);
  const double ramp = std::abs(speed - from) / acceleration;
  for (double t = period_; t < ramp; t += period_)
    if (!step(Loop::velocity, from + (speed - from) * t / ramp)) return false;
  for (double t = 0.0; t < hold_s; t += period_)
    if (!step(Loop::velocity, speed)) return false;
  return true;
}

bool Guard::meanwhile(const std::function<void()>& work) {
  if (!drive_.lives()) {
    work();
    return trip_ == Trip::none;
  }
  std::packaged_task<void()> task([&work] {
    const sched_param usual{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &usual);
    work();
  });
  std::future<void> done = task.get_future();
  std::jthread thread(std::move(task));  // is waited for, whatever is thrown here
  const auto goes_on = [&done] {
    return done.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  };
  while (goes_on() && powered_)
    if (!step(Loop::velocity, 0.0)) release();
  while (goes_on() && exchange({false, false, last_loop_, rest()})) {
  }
  thread.join();
  done.get();
  return trip_ == Trip::none;
}

/// Of the loop that it is in: a drive may have no other.
double Guard::rest() const { return last_loop_ == Loop::position ? answer_.position_rad : 0.0; }

bool Guard::release() {
  if (released_) return !answer_.enabled;
  released_ = true;
  powered_ = false;
  stage("release");
  // The first cycles are for what is still on its way.
  int cycles = 0, resting = 0;
  for (double t = 0.0; t < kStopWait_s; t += period_) {
    if (!exchange({true, true, last_loop_, rest()})) break;
    resting = std::abs(speed_) < kRest ? resting + 1 : 0;
    if (++cycles > 5 && (resting > 5 || !answer_.online || answer_.faulted)) break;
  }
  for (double t = 0.0; t < kOffWait_s; t += period_) {
    if (!exchange({false, false, last_loop_, rest()})) break;
    if (t > 5 * period_ && !answer_.enabled && answer_.online) return true;
  }
  return answer_.online && !answer_.enabled;
}

void Guard::stage(std::string name) {
  stages_.push_back(std::move(name));
  if (watch) watch(*this);
}

}  // namespace servogate::bench
