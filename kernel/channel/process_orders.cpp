// SPDX-License-Identifier: Apache-2.0
// What is asked of a process, and how its program begins and ends.
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/channel/process.hpp"

namespace servogate::channel {

namespace {

using image::at;
using image::ProcessState;
using image::RequestKind;

constexpr image::Place kProgramEnd = image::field(image::kProcessFields, "program_end");

}  // namespace

bool Process::order(const image::Request& request, cycle::ProcessContext& c) noexcept {
  switch (request.kind) {
    case RequestKind::mode:
      if (request.value == static_cast<double>(image::Mode::automatic)) run_on();
      mode_ = static_cast<image::Mode>(static_cast<int>(request.value));
      c.image.processes[static_cast<std::size_t>(config_.index)].mode = mode_;
      break;
    case RequestKind::start:
    case RequestKind::resume:
    case RequestKind::step:
      if (running_) {
        if (aside_ && !come_back(c)) return false;
        held_ = false;
        go_on_ = operator_waits();
        if (request.kind == RequestKind::start && mode_ != image::Mode::step) run_on();
      } else if (request.kind != RequestKind::resume) {
        return start(mode_ == image::Mode::mdi,
                     request.kind == RequestKind::step || mode_ == image::Mode::step, c);
      }
      break;
    case RequestKind::hold:
      held_ = running_;
      retrace_.ends = retrace_.moves;
      forward_.reset();
      break;
    case RequestKind::stop:
    case RequestKind::reset:
      if (request.kind == RequestKind::reset) stop_spindles(c);
      if (running_) {
        follower_.stop();
        stopping_ = true;
        after_stop_ = ProcessState::idle;
        forget_ = forget_ || request.kind == RequestKind::reset;
      } else {
        end_couplings(c);
        if (request.kind == RequestKind::reset) return_spindles(c);
        state_ = ProcessState::idle;
        handshake_.cancel(c.image, base_);
        if (request.kind == RequestKind::reset)
          forget_run(c.image.processes[static_cast<std::size_t>(config_.index)]);
      }
      held_ = false;
      break;
    case RequestKind::override_feed:
      override_ = request.value;
      break;
    case RequestKind::reposition:
      if (!way_.away()) return go_along(true, request, c);
      way_.begin(request.velocity);
      forward_.reset();
      if (retrace_.away) forward_ = request;
      break;
    case RequestKind::retrace:
      return go_along(false, request, c);
    case RequestKind::function:
      add_function(request, c);
      break;
    default:
      break;
  }
  return true;
}

/// What was stepped through goes on to its end; the ends of blocks that are planned already are passed.
void Process::run_on() noexcept {
  if (!running_ || !block_by_block_) return;
  block_by_block_ = false;
  FeederOrder order;
  order.kind = FeederOrder::Kind::run_on;
  order.generation = generation_;
  link_.orders.push(order);
}

bool Process::start(bool manual_data, bool block_by_block, cycle::ProcessContext& c) noexcept {
  if (!manual_data) return_spindles(c);  // what was typed is nothing of the program
  find_own_axes(c);
  if (!acquire(c)) return false;
  if (!manual_data)
    for (axis::Spindle& s : c.spindles)
      if (s.config().process == config_.index) s.uncouple();  // what was typed is nothing of the program
  path::Vector position{};
  FeederOrder order;
  order.kind = FeederOrder::Kind::start;
  order.generation = ++generation_;
  order.manual_data = manual_data_ = manual_data;
  order.block_by_block = block_by_block_ = block_by_block;
  for (std::size_t i = 0; i < c.axes.size(); ++i) order.position[i] = c.image.axes[i].command;
  for (std::size_t i = 0; i < config_.axes.machine.size(); ++i)
    position[i] = order.position[static_cast<std::size_t>(config_.axes.machine[i])];
  for (const int a : config_.axes.machine)
    if (c.axes[static_cast<std::size_t>(a)].process() == config_.index) order.axes |= std::uint32_t{1} << a;
  if (const axis::Spindle* turns = spindle(0, c); turns != nullptr)
    order.spindle_is_axis = manual_data && turns->wants_axis();
  follower_.set_position(position);
  link_.look(generation_, c.image);
  link_.orders.push(order);
  running_ = started_ = true;
  image::ProcessStatus& status = c.image.processes[static_cast<std::size_t>(config_.index)];
  forget_run(status);
  status.run = generation_;
  status.typed = manual_data_;
  forget_ = false;
  override_effective_ = true;
  stopping_ = held_ = go_on_ = false;
  forget_beside();
  probing_.forget();
  taken_ = 0;
  taken_told_ = false;
  probe_told_ = master_told_ = on_master_ = tapping_ = tap_halted_ = false;
  wheel_rests_ = wheel_lost_told_ = wheel_fast_told_ = false;
  stage_ = Stage::none;
  last_speed_ = -1.0;
  state_ = ProcessState::running;
  c.image.packets.set_bit(at(kProgramEnd, base_), false);
  return true;
}

void Process::leave(ProcessState state, cycle::ProcessContext& c) noexcept {
  running_ = stopping_ = held_ = false;
  override_effective_ = true;
  for (const OwnAxis& own : own_axes()) c.axes[own.machine].set_in_position_window(0.0);
  forget_beside();
  forget_neighbours();
  state_ = state;
  stage_ = Stage::none;
  disarm_drives(c);
  handshake_.cancel(c.image, base_);
  if (state != ProcessState::ended) {
    end_couplings(c);
    follower_.stop();
    FeederOrder order;
    order.kind = FeederOrder::Kind::abandon;
    order.generation = generation_;
    link_.orders.push(order);
  } else {
    c.image.packets.set_bit(at(kProgramEnd, base_), !manual_data_);
  }
  if (forget_) forget_run(c.image.processes[static_cast<std::size_t>(config_.index)]);
  forget_ = false;
  release(c);
  if (state != ProcessState::ended || !manual_data_) return_spindles(c);
}

/// They change between two runs only, by the gate.
void Process::find_own_axes(const cycle::ProcessContext& c) noexcept {
  own_count_ = 0;
  for (std::size_t i = 0; i < config_.axes.machine.size() && i < own_.size(); ++i) {
    const int a = config_.axes.machine[i];
    const axis::Axis& axis = c.axes[static_cast<std::size_t>(a)];
    // What a gear has moved is not where the path has it, until the next run begins from there.
    if (running_ && axis.geared()) taken_ |= std::uint32_t{1} << a;
    const bool taken = axis.geared() || (running_ && (taken_ >> a & 1u) != 0);
    if (axis.process() == config_.index && !taken && !is_spindle(a, c))
      own_[own_count_++] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(a)};
  }
}

bool Process::acquire(cycle::ProcessContext& c) noexcept {
  for (const OwnAxis& own : own_axes())
    if (!c.axes[own.machine].acquire(image::AxisOwner::process)) {
      release(c);
      return false;
    }
  return true;
}

void Process::release(cycle::ProcessContext& c) noexcept {
  for (const OwnAxis& own : own_axes()) c.axes[own.machine].release(image::AxisOwner::process);
}

}  // namespace servogate::channel
