// SPDX-License-Identifier: Apache-2.0
// The handwheel that drives the program along its path: an override while it runs, the speed of the ways back
// and forward, and the alarms that tell of it.
#include <algorithm>
#include <cmath>

#include "kernel/channel/alarms/master_alarms.hpp"
#include "kernel/channel/process.hpp"

namespace servogate::channel {

namespace {
constexpr double kTooFast = 1.1;  // of `full_speed`: counts in a window differ by one or two
}  // namespace

/// A program that followed the wheel does not run away when that is not chosen any more.
void Process::watch_wheel(cycle::ProcessContext& c) noexcept {
  const image::PathWheel& wheel = c.image.processes[static_cast<std::size_t>(config_.index)].wheel;
  if (by_wheel_ && !wheel.chosen && running_ && !stopping_) {
    held_ = true;
    retrace_.ends = retrace_.moves;
  }
  by_wheel_ = wheel.chosen;
  const bool lost = running_ && wheel.lost, fast = running_ && std::abs(wheel.turned) > kTooFast;
  if (lost && !wheel_lost_told_) raise_of_motion(alarm::kPathWheelLost, 0.0, 0.0, c);
  if (fast && !wheel_fast_told_)
    raise_of_motion(alarm::kPathWheelFast, std::round(100.0 * std::abs(wheel.turned)), 100.0, c);
  wheel_lost_told_ = lost;
  // Once until the hand rests: a hand at the limit is not told it ten times a second.
  wheel_fast_told_ = fast || (wheel_fast_told_ && wheel.turned != 0.0);
}

/// A thread or a tap goes with its spindle, whatever the wheel does.
double Process::by_wheel(double ratio, const cycle::ProcessContext& c) const noexcept {
  if (!by_wheel_ || on_master_) return ratio;
  const image::PathWheel& wheel = c.image.processes[static_cast<std::size_t>(config_.index)].wheel;
  return std::min(ratio, 1.0) * std::max(0.0, wheel.rate());
}

bool Process::rests_for_wheel(const path::Sample& sample, const cycle::ProcessContext& c) const noexcept {
  if (!by_wheel_ || on_master_ || !running_ || stopping_ || held_ || aside_) return false;
  const image::PathWheel& wheel = c.image.processes[static_cast<std::size_t>(config_.index)].wheel;
  return wheel.rate() <= 0.0 && stage_ == Stage::none && sample.state == path::FollowerState::held;
}

/// The override of a way along the path. One that the wheel leads ends where the hand rests or turns round,
/// so that the axes are free for somebody else.
double Process::way_by_wheel(double ratio, const cycle::ProcessContext& c) noexcept {
  const image::PathWheel& wheel = c.image.processes[static_cast<std::size_t>(config_.index)].wheel;
  if (!wheel.leads) return ratio;
  const double along = retrace_.forward ? wheel.rate() : -wheel.rate();
  if (along <= 0.0 && back_.at_rest()) retrace_.ends = true;
  return std::min(ratio, 1.0) * std::max(0.0, along);
}

}  // namespace servogate::channel
