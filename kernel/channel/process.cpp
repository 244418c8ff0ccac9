// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/process.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::channel {

namespace {

using image::at;
using image::field;
using image::kProcessFields;
using image::Place;
using image::ProcessState;
using image::Reaction;
using image::RequestKind;

constexpr Place kMode = field(kProcessFields, "mode"), kState = field(kProcessFields, "state");
constexpr Place kRunning = field(kProcessFields, "running"), kHeld = field(kProcessFields, "held");
constexpr Place kInPosition = field(kProcessFields, "in_position"), kRapid = field(kProcessFields, "rapid");
constexpr Place kProgramEnd = field(kProcessFields, "program_end"), kLine = field(kProcessFields, "line");
constexpr Place kFeed = field(kProcessFields, "feed"), kOverride = field(kProcessFields, "override");
constexpr Place kStopBit = field(kProcessFields, "stop"), kFeedEnable = field(kProcessFields, "feed_enable");
constexpr Place kFeedOverride = field(kProcessFields, "feed_override");

}  // namespace

Process::Process(const ProcessConfig& config)
    : config_(config),
      link_(config.path),
      feeder_(config.path, config.axes, link_, config.index),
      follower_(config.path, link_.track),
      base_(image::process_base(config.index)) {}

Process::~Process() = default;

void Process::load(InterpreterFactory factory) {
  feeder_.load(std::move(factory));
  loaded_.store(true, std::memory_order_release);
}

void Process::load(InterpreterFactory factory, program::Tables tables) {
  feeder_.load(std::move(factory), std::move(tables));
  loaded_.store(true, std::memory_order_release);
}

void Process::published(std::span<std::uint64_t> counts) const noexcept {
  counts[0] = link_.track.visible();
  counts[1] = link_.events.written();
  counts[2] = link_.at_once.written();
}

void Process::interpolate(cycle::ProcessContext& c) noexcept {
  // A record may speak of what its reader published after the program was given up; a replay never reads it.
  published(seen_);
  for (std::size_t i = 0; i < seen_.size(); ++i) seen_[i] = std::min(seen_[i], c.visible[i]);
  c.visible = seen_;
  apply_at_once(c);
  apply_reaction(c);
  apply_hold(c);
  const path::Sample sample = follower_.step(c.visible[0]);
  if (running_) {
    drive_axes(sample, c);
    switch (sample.state) {
      case path::FollowerState::at_stop:
        at_stop(c);
        break;
      case path::FollowerState::at_event:
        at_event(sample.event, c);
        break;
      default:
        break;
    }
    if (running_ && stopping_ && follower_.at_rest()) leave(after_stop_, c);
    surface_speed(c);
  }
  write_status(sample, c);
}

// -- requests
// --------------------------------------------------------------------------------------------------------

bool Process::order(const image::Request& request, cycle::ProcessContext& c) noexcept {
  switch (request.kind) {
    case RequestKind::mode:
      mode_ = static_cast<image::Mode>(static_cast<int>(request.value));
      c.image.processes[static_cast<std::size_t>(config_.index)].mode = mode_;
      break;
    case RequestKind::start:
    case RequestKind::resume:
    case RequestKind::step:
      if (running_) {
        held_ = false;
        go_on_ = operator_waits();
      } else if (request.kind != RequestKind::resume) {
        return start(mode_ == image::Mode::mdi,
                     request.kind == RequestKind::step || mode_ == image::Mode::step, c);
      }
      break;
    case RequestKind::hold:
      held_ = running_;
      break;
    case RequestKind::stop:
    case RequestKind::reset:
      if (request.kind == RequestKind::reset) stop_spindles(c);
      if (running_) {
        follower_.stop();
        stopping_ = true;
        after_stop_ = ProcessState::idle;
      } else {
        state_ = ProcessState::idle;
        handshake_.cancel(c.image, base_);
      }
      held_ = false;
      break;
    case RequestKind::override_feed:
      override_ = request.value;
      break;
    default:
      break;
  }
  return true;
}

bool Process::start(bool manual_data, bool block_by_block, cycle::ProcessContext& c) noexcept {
  if (!acquire(c)) return false;
  path::Vector position{};
  FeederOrder order;
  order.kind = FeederOrder::Kind::start;
  order.generation = ++generation_;
  order.manual_data = manual_data_ = manual_data;
  order.block_by_block = block_by_block;
  for (std::size_t i = 0; i < c.axes.size(); ++i) order.position[i] = c.image.axes[i].command;
  for (std::size_t i = 0; i < config_.axes.machine.size(); ++i)
    position[i] = order.position[static_cast<std::size_t>(config_.axes.machine[i])];
  follower_.set_position(position);
  link_.packets_of(generation_) = c.image.packets;
  link_.orders.push(order);
  running_ = true;
  shown_command_ = 0;
  c.image.processes[static_cast<std::size_t>(config_.index)].line = 0;
  stopping_ = held_ = go_on_ = false;
  stage_ = Stage::none;
  last_speed_ = -1.0;
  state_ = ProcessState::running;
  c.image.packets.set_bit(at(kProgramEnd, base_), false);
  return true;
}

void Process::leave(ProcessState state, cycle::ProcessContext& c) noexcept {
  running_ = stopping_ = held_ = false;
  state_ = state;
  stage_ = Stage::none;
  surface_speed_ = 0.0;
  handshake_.cancel(c.image, base_);
  if (state != ProcessState::ended) {
    follower_.stop();
    FeederOrder order;
    order.kind = FeederOrder::Kind::abandon;
    order.generation = generation_;
    link_.orders.push(order);
  } else {
    c.image.packets.set_bit(at(kProgramEnd, base_), true);
  }
  release(c);
}

bool Process::acquire(cycle::ProcessContext& c) noexcept {
  for (const int a : config_.axes.machine)
    if (!c.axes[static_cast<std::size_t>(a)].acquire(image::AxisOwner::process)) {
      release(c);
      return false;
    }
  return true;
}

void Process::release(cycle::ProcessContext& c) noexcept {
  for (const int a : config_.axes.machine)
    c.axes[static_cast<std::size_t>(a)].release(image::AxisOwner::process);
}

// -- motion
// ----------------------------------------------------------------------------------------------------------

void Process::apply_reaction(cycle::ProcessContext& c) noexcept {
  if (!running_ || stopping_) return;
  bool taken = false;
  for (const int a : config_.axes.machine)
    taken = taken || c.axes[static_cast<std::size_t>(a)].stopped_by_reaction();
  if (c.reaction < Reaction::stop_at_block_end && !taken) return;
  follower_.stop();
  stopping_ = true;
  after_stop_ = ProcessState::stopped_by_alarm;
  handshake_.cancel(c.image, base_);
}

void Process::apply_hold(cycle::ProcessContext& c) noexcept {
  const image::Packets& k = c.image.packets;
  bool hold = held_ || k.bit(at(kStopBit, base_)) || !k.bit(at(kFeedEnable, base_));
  for (const int a : config_.axes.machine) hold = hold || !c.axes[static_cast<std::size_t>(a)].feed_enabled();
  if (hold)
    follower_.hold();
  else
    follower_.resume();
  const double by_plc = k.number(at(kFeedOverride, base_)) / 100.0;
  follower_.set_override(by_plc > 0.0 ? by_plc : override_);
}

void Process::drive_axes(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  for (std::size_t i = 0; i < config_.axes.machine.size(); ++i) {
    axis::Axis& a = c.axes[static_cast<std::size_t>(config_.axes.machine[i])];
    if (a.owner() == image::AxisOwner::process)
      a.set_process({sample.position[i], sample.velocity[i], sample.acceleration[i],
                     sample.target[i] - sample.position[i]});
  }
}

bool Process::in_position(cycle::ProcessContext& c) const noexcept {
  return std::all_of(config_.axes.machine.begin(), config_.axes.machine.end(),
                     [&](int a) { return c.axes[static_cast<std::size_t>(a)].in_position(); });
}

void Process::at_stop(cycle::ProcessContext& c) noexcept {
  if (in_position(c)) follower_.release_stop();
}

void Process::at_event(std::uint32_t id, cycle::ProcessContext& c) noexcept {
  if (stage_ == Stage::none) {
    for (; events_read_ < c.visible[1] && link_.events[events_read_].generation != generation_;)
      link_.events.free_below(++events_read_);
    if (events_read_ >= c.visible[1]) return;
    event_ = link_.events[events_read_];
    if (event_.id != id || !in_position(c)) return;
    link_.events.free_below(++events_read_);
    stage_ = Stage::entered;
    waited_s_ = 0.0;
    go_on_ = false;
  }
  if (!execute(event_, c)) return;
  stage_ = Stage::none;
  if (running_) state_ = ProcessState::running;
  follower_.release_event();
}

void Process::write_status(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  image::ProcessStatus& out = c.image.processes[static_cast<std::size_t>(config_.index)];
  const bool held = running_ && sample.state == path::FollowerState::held;
  out.mode = mode_;
  out.state = held ? ProcessState::held : state_;
  out.rapid = running_ && sample.rapid && sample.feed > 0.0;
  if (running_) {
    // The newest of what began: a motion or an event. Between two events the motion before them is long over.
    if (sample.tag.command != shown_command_) {
      shown_command_ = sample.tag.command;
      out.line = sample.tag.line;
      out.file = sample.tag.file;
    }
    out.blocks_done = static_cast<std::int64_t>(sample.tag.command);
    if (stage_ != Stage::none) out.line = event_.line;
  }
  out.feed_mm_s = running_ ? sample.feed : 0.0;
  out.override_ratio = follower_.override_ratio();
  out.starved = sample.starved;
  if (sample.starved != starved_ && running_) {
    image::AlarmRecord r;
    r.number = cycle::alarm::kStarved;
    r.process = static_cast<std::int8_t>(config_.index);
    r.line = out.line;
    r.value = sample.starved;
    c.notices.add(r);
  }
  starved_ = sample.starved;
  image::Packets& k = c.image.packets;
  k.set_number(at(kMode, base_), static_cast<double>(out.mode));
  k.set_number(at(kState, base_), static_cast<double>(out.state));
  k.set_bit(at(kRunning, base_), running_);
  k.set_bit(at(kHeld, base_), held);
  k.set_bit(at(kInPosition, base_), in_position(c));
  k.set_bit(at(kRapid, base_), out.rapid);
  k.set_number(at(kLine, base_), out.line);
  k.set_number(at(kFeed, base_), out.feed_mm_s * 60.0);
  k.set_number(at(kOverride, base_), std::round(out.override_ratio * 100.0));
}

void Process::raise(image::AlarmNumber number, const Event& event, double value, double limit,
                    cycle::ProcessContext& c) noexcept {
  image::AlarmRecord r;
  r.number = number;
  r.process = static_cast<std::int8_t>(config_.index);
  r.line = event.line;
  r.block = event.block;
  r.value = value;
  r.limit = limit;
  c.notices.add(r);
}

}  // namespace servogate::channel
