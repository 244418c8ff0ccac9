// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/process.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::channel {

namespace {

using image::at;
using image::field;
using image::kProcessFields;
using image::Place;
using image::ProcessState;
using image::Reaction;

constexpr Place kStopBit = field(kProcessFields, "stop"), kFeedEnable = field(kProcessFields, "feed_enable");
constexpr Place kFeedOverride = field(kProcessFields, "feed_override");
constexpr Place kReadInEnable = field(kProcessFields, "read_in_enable");

}  // namespace

Process::Process(const ProcessConfig& config)
    : config_(config),
      link_(config.path),
      feeder_(config.path, config.axes, link_, config.index),
      follower_(config.path, link_.track),
      back_(WayLink::small(config.path), link_.way.track),
      base_(image::process_base(config.index)),
      meeting_(config.meeting != nullptr ? *config.meeting : alone_) {
  feeder_.set_neighbours(meeting_.count(), config.supplier);
  probing_.configure(config.probe, config.probe_latch);
}

Process::~Process() = default;

// -- outside the cycle
// --------------------------------------------------------------------------------------------------------

void Process::load(InterpreterFactory factory) {
  feeder_.load(std::move(factory));
  programs_.fetch_add(1, std::memory_order_release);
  changes_.fetch_add(1, std::memory_order_release);
}

void Process::load(InterpreterFactory factory, program::Tables tables) {
  feeder_.load(std::move(factory), std::move(tables));
  programs_.fetch_add(1, std::memory_order_release);
  changes_.fetch_add(1, std::memory_order_release);
}

void Process::renew(InterpreterFactory factory, program::Tables tables) {
  feeder_.load(std::move(factory), std::move(tables));
  changes_.fetch_add(1, std::memory_order_release);
}

void Process::restart(RestartFactory once) {
  feeder_.begin_next_with(std::move(once));
  changes_.fetch_add(1, std::memory_order_release);
}

void Process::forget_manual() {
  feeder_.forget_manual();
  changes_.fetch_add(1, std::memory_order_release);
}

void Process::begin_beside() noexcept {
  shown_then_ = shown();
  feeder_.hold();
}

void Process::end_beside() noexcept {
  feeder_.let_go();
  shown_then_.reset();
}

void Process::set_manual_block(std::string block) {
  feeder_.set_manual_block(std::move(block));
  changes_.fetch_add(1, std::memory_order_release);
}

void Process::set_touch(const TouchOrder& order) {
  feeder_.set_touch(order);
  changes_.fetch_add(1, std::memory_order_release);
}

// -- in the cycle
// --------------------------------------------------------------------------------------------------------

/// An event lies in its queue before the path speaks of it: the path is looked at first.
Process::Shown Process::shown() const noexcept {
  if (shown_then_) return *shown_then_;
  Shown s;
  s.entries = link_.track.visible();
  s.events = link_.events.written();
  s.at_once = link_.at_once.written();
  return s;
}

void Process::published(std::span<std::uint64_t> counts) const noexcept {
  // A run is begun before anything of it is published: what the path shows of it is known to be of it.
  const Shown now = shown();
  const Link::Begin* begin = link_.begin_of(generation_);
  const auto since = [begin](std::uint64_t end, std::uint64_t from) {
    return begin != nullptr && end > from ? end - from : 0;
  };
  const Link::Begin from = begin != nullptr ? *begin : Link::Begin{};
  counts[kTrack] = since(now.entries, from.track.entry);
  counts[kEvents] = since(now.events, from.event);
  counts[kAtOnce] = since(now.at_once, from.at_once);
  counts[kWay] = retrace_.moves ? way_published() : 0;
  counts[kPrograms] = programs_.load(std::memory_order_acquire);
  counts[kChanges] = changes();
}

/// How far the track may be read in this cycle; sets the same of the event queues. What lies before the run
/// under way is dropped.
std::uint64_t Process::look(const cycle::ProcessContext& c) noexcept {
  const auto [entries, events, at_once] = shown();
  const Link::Begin* begin = link_.begin_of(generation_);
  const auto drop = [](path::Ring<Event>& ring, std::uint64_t& read, std::uint64_t below) {
    if (read < below) ring.free_below(read = below);
  };
  drop(link_.events, events_read_, begin != nullptr ? begin->event : events);
  drop(link_.at_once, at_once_read_, begin != nullptr ? begin->at_once : at_once);
  // A record may speak of what its reader published after the program was given up; a replay never reads it.
  std::array<std::uint64_t, kCrossingsEach> seen{};
  published(seen);
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = std::min(seen[i], c.visible[i]);
  if (started_) seen[kTrack] = seen[kEvents] = seen[kAtOnce] = seen[kWay] = 0;
  const bool begins = std::exchange(started_, false);
  if (seen[kPrograms] != programs_seen_ && !running_) {
    forget_run(c.image.processes[static_cast<std::size_t>(config_.index)]);
    if (state_ == ProcessState::ended || state_ == ProcessState::stopped) state_ = ProcessState::idle;
  }
  programs_seen_ = seen[kPrograms];
  if (begins) run_of_programs_ = programs_seen_;
  meeting_.show_programs(config_.index, programs_seen_);
  events_end_ = events_read_;
  at_once_end_ = at_once_read_;
  if (begin == nullptr) return entries;
  events_end_ = std::max(events_read_, begin->event + seen[kEvents]);
  at_once_end_ = std::max(at_once_read_, begin->at_once + seen[kAtOnce]);
  if (seen[kTrack] == 0) return std::min(entries, begin->track.entry);
  follower_.skip_to(begin->track);
  return begin->track.entry + seen[kTrack];
}

void Process::interpolate(cycle::ProcessContext& c) noexcept {
  find_own_axes(c);
  const std::uint64_t entries = look(c);
  apply_at_once(c);
  apply_reaction(c);
  apply_hold(c);
  probing_.look(c.image, c.axes);
  const path::Sample sample = follower_.step(entries);
  if (running_) {
    show_motion(sample, c.image.processes[static_cast<std::size_t>(config_.index)]);
    if (!aside_) drive_axes(sample, c);
    watch_geared(sample, c);
    follow_master(sample, c);
    watch_probe(sample, c);
    if (sample.feed > 0.0 && !sample.rapid)
      cutting_.add(row_ != 0 ? row_ : c.image.processes[static_cast<std::size_t>(config_.index)].tool,
                   seconds(c));
    if (aside_) work_beside(c);
    switch (aside_ ? path::FollowerState::held : sample.state) {
      case path::FollowerState::at_stop:
        at_stop(c);
        break;
      case path::FollowerState::at_event:
        at_event(sample.event, c);
        break;
      default:
        break;
    }
    if (running_ && stopping_ && follower_.at_rest() && !retrace_.moves) leave(after_stop_, c);
  }
  surface_speed(c);
  write_status(sample, c);
}

// -- motion
// ----------------------------------------------------------------------------------------------------------

void Process::apply_reaction(cycle::ProcessContext& c) noexcept {
  if (!running_ || stopping_) return;
  bool taken = false;
  for (const OwnAxis& own : own_axes()) {
    const axis::Axis& a = c.axes[own.machine];
    taken = taken || a.stopped_by_reaction() || a.letting_go();
  }
  if (c.reaction < Reaction::stop_at_block_end && !taken) return;
  follower_.stop();
  stopping_ = true;
  image::Stop& stop = c.image.processes[static_cast<std::size_t>(config_.index)].stop;
  stop = c.reaction < Reaction::stop_at_block_end ? stop_without_alarm(c) : image::Stop{};
  after_stop_ = stop.cause == image::StopCause::none ? ProcessState::stopped_by_alarm : ProcessState::stopped;
  handshake_.cancel(c.image, base_);
}

/// Who took the axes from the program where it was no alarm.
image::Stop Process::stop_without_alarm(const cycle::ProcessContext& c) const noexcept {
  if (!c.drives_wanted) return {image::StopCause::drives_off, c.drives_asker, -1};
  for (const OwnAxis& own : own_axes())
    if (!c.axes[own.machine].power_permitted())
      return {image::StopCause::enable_withdrawn, image::Asker::plc, static_cast<std::int8_t>(own.machine)};
  return {};
}

void Process::apply_hold(cycle::ProcessContext& c) noexcept {
  const image::Packets& k = c.image.packets;
  watch_wheel(c);
  if (k.bit(at(kStopBit, base_))) held_ = running_;  // it goes on when somebody says so
  bool hold = held_ || aside_ || !k.bit(at(kFeedEnable, base_));
  for (const OwnAxis& own : own_axes()) hold = hold || !c.axes[own.machine].feed_enabled();
  hold = hold || out_of_step(c) != nullptr;
  if (hold)
    follower_.hold();
  else
    follower_.resume();
  const double by_plc = k.number(at(kFeedOverride, base_)) / 100.0;
  asked_ratio_ = !override_effective_ ? 1.0 : by_plc > 0.0 ? by_plc : override_;
  follower_.set_override(by_wheel(asked_ratio_, c));
  const axis::Spindle* turns = spindle(0, c);
  follower_.set_spindle(
      turns == nullptr
          ? -1.0
          : std::abs(c.image.spindles[static_cast<std::size_t>(turns->index())].command_rpm) / 60.0);
  follower_.set_master(master(c));
}

void Process::drive_axes(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  for (const OwnAxis& own : own_axes()) {
    axis::Axis& a = c.axes[own.machine];
    const std::size_t i = own.path;
    if (a.owner() == image::AxisOwner::process)
      a.set_process({sample.position[i], sample.velocity[i], sample.acceleration[i],
                     sample.target[i] - sample.position[i], sample.master.bound});
  }
}

bool Process::in_position(cycle::ProcessContext& c) const noexcept {
  const std::span<const OwnAxis> own = own_axes();
  return std::all_of(own.begin(), own.end(),
                     [&](const OwnAxis& a) { return c.axes[a.machine].in_position(); });
}

void Process::at_stop(cycle::ProcessContext& c) noexcept {
  if (in_position(c)) follower_.release_stop();
}

void Process::at_event(std::uint32_t id, cycle::ProcessContext& c) noexcept {
  if (stage_ == Stage::none) {
    if (events_read_ >= events_end_) return;
    event_ = link_.events[events_read_];
    if (event_.id != id || !in_position(c)) return;
    show_event(event_, c.image.processes[static_cast<std::size_t>(config_.index)]);
    // What is held begins nothing: no word goes to the PLC.
    if (held_ || !c.image.packets.bit(at(kReadInEnable, base_))) return;
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

void Process::raise(image::AlarmNumber number, const Event& event, double value, double limit,
                    cycle::ProcessContext& c, int axis) noexcept {
  image::AlarmRecord r;
  r.number = number;
  r.process = static_cast<std::int8_t>(config_.index);
  r.axis = static_cast<std::int8_t>(axis);
  r.line = event.line;
  r.file = event.file;
  r.run = generation_;
  r.block = event.block;
  r.value = value;
  r.limit = limit;
  if (number == cycle::alarm::kProgramWarning)  // the same one in the same line is said once
    r.key = std::uint64_t{static_cast<std::uint32_t>(event.line)} << 32 |
            static_cast<std::uint32_t>(static_cast<std::int64_t>(limit));
  c.notices.add(r);
}

}  // namespace servogate::channel
