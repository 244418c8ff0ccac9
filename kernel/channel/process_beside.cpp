// SPDX-License-Identifier: Apache-2.0
// Work beside a held program: its axes are jogged away and return, functions are typed, and the program goes
// on only where and as it was held.
#include <algorithm>
#include <cmath>

#include "kernel/channel/process.hpp"

namespace servogate::channel {

namespace {

using image::Function;
using image::ProcessState;

constexpr double kSamePlace = 1e-6;  ///< mm or degrees: the set-point may step by it
constexpr double kNothing = 1e-9;    ///< mm or degrees
constexpr double kSameSpeed = 0.5;   ///< rpm

double signed_rpm(axis::SpindleMode mode, double rpm) noexcept {
  switch (mode) {
    case axis::SpindleMode::cw:
      return std::abs(rpm);
    case axis::SpindleMode::ccw:
      return -std::abs(rpm);
    default:
      return 0.0;
  }
}

}  // namespace

/// Only somebody's word lets the program go on from here.
bool Process::rests_for_operator() const noexcept {
  if (!running_ || stopping_ || !follower_.at_rest()) return false;
  return aside_ || operator_waits() || wheel_rests_ || (held_ && stage_ == Stage::none);
}

cycle::Beside Process::beside(const cycle::ProcessContext& c) const noexcept {
  cycle::Beside b;
  b.possible = rests_for_operator();
  if (!b.possible || !aside_) return b;
  b.away = way_.away();
  b.returns = way_.returns() || retrace_.moves;
  b.retraced = retrace_.away;
  b.retraced_mm = retrace_.behind;
  if (retrace_.moves && own_count_ != 0) b.axis = static_cast<std::int8_t>(own_[0].machine);
  b.full = way_.full();
  b.functions = function_count_ != 0;
  b.functions_full = function_count_ == functions_.size();
  if (b.away) {
    b.axis = static_cast<std::int8_t>(way_.axis());
    b.distance = c.axes[static_cast<std::size_t>(way_.axis())].setpoint().x - way_.from();
  }
  const std::int32_t tool = c.image.processes[static_cast<std::size_t>(config_.index)].tool;
  if (tool != held_as_.tool) b.tool = held_as_.tool;
  for (std::size_t s = 0; s < c.spindles.size() && s < held_as_.mode.size(); ++s) {
    const axis::Spindle& spindle = c.spindles[s];
    if (spindle.config().process != config_.index) continue;
    // By a cutting speed it turns as its axis stands, and does so again behind the hold.
    const bool by_surface = held_as_.surface_speed > 0.0;
    const bool same_speed = by_surface || held_as_.mode[s] == axis::SpindleMode::stop ||
                            std::abs(spindle.ordered_rpm() - held_as_.rpm[s]) < kSameSpeed;
    if (spindle.mode() == held_as_.mode[s] && same_speed) continue;
    b.spindle = static_cast<std::int8_t>(s);
    b.spindle_rpm = signed_rpm(held_as_.mode[s], held_as_.rpm[s]);
  }
  return b;
}

void Process::leave_path(int axis, cycle::ProcessContext& c) noexcept {
  if (!rests_for_operator()) return;
  step_aside(c);
  way_.leave(axis, c.axes[static_cast<std::size_t>(axis)].setpoint().x);
}

void Process::step_aside(cycle::ProcessContext& c) noexcept {
  if (aside_) return;
  aside_ = true;
  way_.clear();
  retrace_.away = false;
  forward_.reset();
  Held& h = held_as_;
  const std::span<const OwnAxis> own = own_axes();
  for (const OwnAxis& a : own) h.place[a.path] = h.on_path[a.path] = c.axes[a.machine].setpoint().x;
  for (std::size_t s = 0; s < c.spindles.size() && s < h.mode.size(); ++s) {
    h.mode[s] = c.spindles[s].mode();
    h.rpm[s] = c.spindles[s].ordered_rpm();
  }
  h.tool = c.image.processes[static_cast<std::size_t>(config_.index)].tool;
  h.event = event_;
  h.stage = stage_;
  h.waited_s = waited_s_;
  h.state = state_;
  h.surface_spindle = surface_spindle_;
  h.surface_speed = surface_speed_;
  h.surface_limit = surface_limit_;
  h.surface_center = surface_center_;
  release(c);
}

/// The axes are the program's again, where it left them; false: they are not there, or not free.
bool Process::come_back(cycle::ProcessContext& c) noexcept {
  for (const OwnAxis& own : own_axes())
    if (std::abs(c.axes[own.machine].setpoint().x - held_as_.place[own.path]) > kSamePlace) return false;
  if (function_count_ != 0 || !acquire(c)) return false;
  aside_ = false;
  way_.clear();
  surface_spindle_ = held_as_.surface_spindle;
  surface_speed_ = held_as_.surface_speed;
  surface_limit_ = held_as_.surface_limit;
  surface_center_ = held_as_.surface_center;
  return true;
}

void Process::forget_beside() noexcept {
  aside_ = false;
  way_.clear();
  retrace_.away = retrace_.moves = false;
  forward_.reset();
  function_count_ = 0;
}

void Process::add_function(const image::Request& request, cycle::ProcessContext& c) noexcept {
  if (function_count_ == functions_.size() || !rests_for_operator()) return;
  step_aside(c);
  const image::ProcessStatus& status = c.image.processes[static_cast<std::size_t>(config_.index)];
  Event e;
  e.line = status.line;
  e.file = static_cast<std::int16_t>(status.file);
  e.executed = static_cast<std::uint32_t>(status.blocks_done);
  e.generation = generation_;
  e.number = request.packet;
  const auto spindle = [&e, &request](program::SpindleMode mode) {
    e.kind = EventKind::spindle;
    e.mode = mode;
    e.value = request.value;
  };
  switch (static_cast<Function>(request.index)) {
    case Function::m:
      e.kind = EventKind::m_function;
      e.code = static_cast<std::int32_t>(request.value);
      break;
    case Function::tool:
      e.kind = EventKind::tool;
      e.code = static_cast<std::int32_t>(request.value);
      e.code2 = request.format;
      break;
    case Function::spindle_clockwise:
      spindle(program::SpindleMode::cw);
      break;
    case Function::spindle_counterclockwise:
      spindle(program::SpindleMode::ccw);
      break;
    case Function::spindle_stop:
      spindle(program::SpindleMode::stop);
      break;
  }
  functions_[function_count_++] = e;
  if (function_count_ > 1) return;
  event_ = e;
  stage_ = Stage::entered;
  waited_s_ = 0.0;
}

/// One cycle of the typed functions, one behind the other, and of the way back.
void Process::work_beside(cycle::ProcessContext& c) noexcept {
  way_.step(c.axes);
  if (forward_ && !way_.returns()) {
    const image::Request request = *forward_;
    forward_.reset();
    if (!way_.away() && !stopping_) go_along(true, request, c);
  }
  if (retrace_.moves) follow_way(c);
  if (function_count_ == 0 || stopping_ || !execute(event_, c) || function_count_ == 0) return;
  std::move(functions_.begin() + 1, functions_.begin() + static_cast<std::ptrdiff_t>(function_count_),
            functions_.begin());
  if (--function_count_ != 0) {
    event_ = functions_.front();
    stage_ = Stage::entered;
  } else {
    event_ = held_as_.event;
    stage_ = held_as_.stage;
    state_ = held_as_.state;
  }
  waited_s_ = function_count_ != 0 ? 0.0 : held_as_.waited_s;
}

void Process::show_beside(cycle::ProcessContext& c) const noexcept {
  for (const OwnAxis& own : own_axes()) {
    const double away = c.axes[own.machine].setpoint().x - held_as_.on_path[own.path];
    const bool on_path = !aside_ || retrace_.moves || std::abs(away) < kNothing;
    c.image.axes[own.machine].beside = on_path ? 0.0 : away;
  }
}

}  // namespace servogate::channel
