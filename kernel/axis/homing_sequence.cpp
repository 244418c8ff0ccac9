// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/homing_sequence.hpp"

#include <limits>

namespace servogate::axis {

namespace {
constexpr std::uint32_t bit(std::size_t i) { return std::uint32_t{1} << i; }
}  // namespace

bool HomingSequence::begin_next(std::span<Axis> axes) noexcept {
  int order = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (waiting_ & bit(i)) order = std::min(order, axes[i].config().homing.order);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(waiting_ & bit(i)) || axes[i].config().homing.order != order) continue;
    if (!axes[i].home()) return false;
    active_ |= bit(i);
  }
  waiting_ &= ~active_;
  return true;
}

bool HomingSequence::start(std::span<Axis> axes, std::uint32_t mask) noexcept {
  if (running() || mask == 0) return false;
  for (std::size_t i = 0; i < axes.size(); ++i)
    if ((mask & bit(i)) && !(axes[i].motion_permitted() && axes[i].standstill())) return false;
  waiting_ = remaining_ = mask;
  active_ = 0;
  state_ = State::running;
  if (begin_next(axes)) return true;
  abort(axes);
  return false;
}

void HomingSequence::step(std::span<Axis> axes) noexcept {
  if (!running()) return;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(active_ & bit(i)) || axes[i].homing().active()) continue;
    active_ &= ~bit(i);
    if (axes[i].homing().state() != Homing::State::done) {
      abort(axes);
      state_ = State::failed;
      return;
    }
    remaining_ &= ~bit(i);
  }
  if (active_ != 0) return;
  if (waiting_ == 0) {
    state_ = State::done;
  } else if (!begin_next(axes)) {
    abort(axes);
    state_ = State::failed;
  }
}

void HomingSequence::abort(std::span<Axis> axes) noexcept {
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (active_ & bit(i)) axes[i].stop();
  waiting_ = active_ = 0;
  if (running()) state_ = State::idle;
}

}  // namespace servogate::axis
