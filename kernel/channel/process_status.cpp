// SPDX-License-Identifier: Apache-2.0
// What a process shows: where its program is, what it waits for, its words in packet K.
#include <algorithm>
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/channel/process.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::channel {

namespace {

using image::at;
using image::field;
using image::kProcessFields;
using image::Place;
using image::ProcessState;
using image::WaitReason;

constexpr Place kMode = field(kProcessFields, "mode"), kState = field(kProcessFields, "state");
constexpr Place kRunning = field(kProcessFields, "running"), kHeld = field(kProcessFields, "held");
constexpr Place kInPosition = field(kProcessFields, "in_position"), kRapid = field(kProcessFields, "rapid");
constexpr Place kLine = field(kProcessFields, "line"), kFeed = field(kProcessFields, "feed");
constexpr Place kOverride = field(kProcessFields, "override"), kStopBit = field(kProcessFields, "stop");
constexpr Place kRetraced = field(kProcessFields, "retraced");
constexpr Place kFeedEnable = field(kProcessFields, "feed_enable");
constexpr Place kReadInEnable = field(kProcessFields, "read_in_enable");
constexpr Place kAxisFeedEnable = field(image::kAxisFields, "feed_enable");

struct HandshakeWait {
  WaitReason reason;
  Place ack;
};
/// Index = HandshakeWord.
constexpr HandshakeWait kHandshakes[] = {{WaitReason::m_acknowledge, field(kProcessFields, "m_ack")},
                                         {WaitReason::s_acknowledge, field(kProcessFields, "s_ack")},
                                         {WaitReason::t_acknowledge, field(kProcessFields, "t_ack")},
                                         {WaitReason::h_acknowledge, field(kProcessFields, "h_ack")}};

static_assert(static_cast<int>(image::Compare::ge) == static_cast<int>(program::Wait::Compare::ge) &&
              static_cast<int>(image::Compare::ne) == static_cast<int>(program::Wait::Compare::ne));

image::Wait of(WaitReason reason, Place place = {}, int axis = -1) noexcept {
  image::Wait wait;
  wait.reason = reason;
  wait.place = place;
  wait.axis = static_cast<std::int8_t>(axis);
  return wait;
}

}  // namespace

// -- where the program is
// --------------------------------------------------------------------------------------------------------

/// The newest of what began, a motion or an event, gives the line. A motion begins when its tag appears; that
/// of the run before stays on the path until then.
void Process::show_motion(const path::Sample& sample, image::ProcessStatus& status) noexcept {
  to_go_ = sample.distance_to_go;
  if (sample.tag == shown_) return;
  shown_ = sample.tag;
  if (shown_.command >> 32 != generation_) return;
  status.line = shown_.line;
  status.file = shown_.file;
  status.blocks_done =
      std::max(status.blocks_done, static_cast<std::int64_t>(static_cast<std::uint32_t>(shown_.command)));
}

void Process::show_event(const Event& event, image::ProcessStatus& status) const noexcept {
  status.line = event.line;
  status.file = event.file;
  status.blocks_done = std::max(status.blocks_done, std::int64_t{event.executed});
}

void Process::forget_run(image::ProcessStatus& status) const noexcept {
  status.line = status.file = status.message = 0;
  status.blocks_done = 0;
  status.stop = {};
  status.typed = false;
}

// -- what it waits for
// --------------------------------------------------------------------------------------------------------

image::Wait Process::wait(const path::Sample& sample, const cycle::ProcessContext& c) const noexcept {
  if (!running_ || stopping_ || !follower_.at_rest()) return {};
  if (function_count_ != 0) return wait_at_event(c);
  if (retrace_.moves && back_.waits_for_spindle()) return of(WaitReason::spindle_stands);
  switch (sample.state) {
    case path::FollowerState::at_event: {
      const image::Wait settling = stage_ == Stage::none ? wait_for_position(c) : image::Wait{};
      if (settling.reason != WaitReason::none) return settling;
      // Whatever it waits for beside: behind it, only that somebody goes on helps.
      const image::Wait hold = wait_for_go_on(c);
      return hold.reason != WaitReason::none ? hold : wait_at_event(c);
    }
    case path::FollowerState::at_stop:
      return wait_for_position(c);
    case path::FollowerState::held:
      return wait_on_path(c);
    default:
      return follower_.waits_for_spindle() ? of(WaitReason::spindle_stands) : image::Wait{};
  }
}

/// A spindle that follows is at speed when it is in step.
image::Wait Process::wait_for_step(const axis::Spindle* follower) noexcept {
  image::Wait wait = of(WaitReason::signal);
  if (follower != nullptr)
    wait.place = at(image::field(image::kSpindleFields, "at_speed"), image::spindle_base(follower->index()));
  wait.compare = image::Compare::eq;
  wait.value = 1.0;
  return wait;
}

/// The axis has its power when the spindle has become it, and none when it is a spindle again.
image::Wait Process::wait_for_change(const axis::Spindle* turns) noexcept {
  image::Wait wait = of(WaitReason::signal);
  if (turns != nullptr)
    wait.place = at(image::field(image::kAxisFields, "enabled"), image::axis_base(turns->config().axis));
  wait.compare = image::Compare::eq;
  wait.value = turns != nullptr && turns->wants_axis() ? 1.0 : 0.0;
  return wait;
}

image::Wait Process::wait_for_go_on(const cycle::ProcessContext& c) const noexcept {
  if (c.image.packets.bit(at(kStopBit, base_))) return of(WaitReason::plc_hold, at(kStopBit, base_));
  return held_ ? of(WaitReason::operator_hold) : image::Wait{};
}

image::Wait Process::wait_at_event(const cycle::ProcessContext& c) const noexcept {
  if (stage_ == Stage::none)
    return c.image.packets.bit(at(kReadInEnable, base_))
               ? image::Wait{}
               : of(WaitReason::read_in_enable, at(kReadInEnable, base_));
  if (stage_ == Stage::handshaking) {
    const HandshakeWait& word = kHandshakes[static_cast<int>(handshake_.word())];
    image::Wait wait = of(word.reason, at(word.ack, base_));
    wait.code = event_.code;
    wait.value = word.reason == WaitReason::s_acknowledge ? last_speed_ : 0.0;
    return wait;
  }
  image::Wait wait;
  switch (event_.kind) {
    case EventKind::wait:
      wait = of(WaitReason::signal, event_.place);
      wait.compare = static_cast<image::Compare>(event_.compare);
      wait.value = event_.value;
      return wait;
    case EventKind::process_start:
    case EventKind::process_restart:
    case EventKind::process_wait:
      wait = of(WaitReason::signal);
      wait.code = event_.number + 1;  // in place of a place
      wait.compare = event_.kind == EventKind::process_wait      ? image::Compare::eq
                     : event_.kind == EventKind::process_restart ? image::Compare::ne
                                                                 : image::Compare::lt;
      return wait;
    case EventKind::dwell:
      wait = of(WaitReason::dwell);
      wait.value = event_.value;
      return wait;
    case EventKind::spindle_coupling:
      return wait_for_step(spindle(event_.number, c));
    case EventKind::spindle_axis:
      return wait_for_change(spindle(0, c));
    case EventKind::stop:
      return of(WaitReason::program_stop);
    case EventKind::optional_stop:
      return of(WaitReason::optional_stop);
    case EventKind::block_end:
      return of(WaitReason::block_end);
    default:
      return wait;
  }
}

/// Why the feed is held; several causes come one after the other.
image::Wait Process::wait_on_path(const cycle::ProcessContext& c) const noexcept {
  const image::Packets& k = c.image.packets;
  if (const image::Wait hold = wait_for_go_on(c); hold.reason != WaitReason::none) return hold;
  if (!k.bit(at(kFeedEnable, base_))) return of(WaitReason::feed_enable, at(kFeedEnable, base_));
  for (const OwnAxis& own : own_axes())
    if (!c.axes[own.machine].feed_enabled())
      return of(WaitReason::axis_feed_enable, at(kAxisFeedEnable, image::axis_base(own.machine)),
                own.machine);
  if (follower_.override_ratio() <= 0.0)
    return of(by_wheel_ && asked_ratio_ > 0.0 ? WaitReason::path_wheel : WaitReason::override_zero);
  const axis::Spindle* apart = out_of_step(c);
  return apart != nullptr ? wait_for_step(apart) : image::Wait{};
}

image::Wait Process::wait_for_position(const cycle::ProcessContext& c) const noexcept {
  for (const OwnAxis& own : own_axes())
    if (!c.axes[own.machine].in_position()) return of(WaitReason::in_position, {}, own.machine);
  return {};
}

// -- status and packet K
// --------------------------------------------------------------------------------------------------------

void Process::write_status(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  image::ProcessStatus& out = c.image.processes[static_cast<std::size_t>(config_.index)];
  const bool before_event = sample.state == path::FollowerState::at_event && stage_ == Stage::none && held_;
  const bool held = running_ && (sample.state == path::FollowerState::held || before_event);
  show_beside(c);
  out.mode = mode_;
  out.state = held && function_count_ == 0 ? ProcessState::held : state_;
  out.rapid = running_ && sample.rapid && sample.feed > 0.0;
  image::Wait wait = this->wait(sample, c);
  wait.line = wait.reason == WaitReason::none ? 0 : out.line;
  wait.since_ns = out.wait.since_ns;
  if (wait != out.wait) {
    wait.since_ns = c.image.now.t_ns;
    out.wait = wait;
  }
  out.feed_mm_s = running_ ? sample.feed + retrace_.feed : 0.0;
  const bool was_retraced = out.retraced;
  out.retraced = running_ && (retrace_.away || (retrace_.moves && retrace_.begun));
  out.retracing = running_ && (retrace_.moves || forward_.has_value());
  out.retraced_mm = out.retraced ? retrace_.behind : 0.0;
  if (out.retraced && retrace_.begun && retrace_.tag.line != 0) {
    out.line = retrace_.tag.line;
    out.file = retrace_.tag.file;
  } else if (was_retraced && running_) {
    out.line = shown_.line;
    out.file = shown_.file;
  }
  wheel_rests_ = rests_for_wheel(sample, c);
  out.wheel.rests = wheel_rests_;
  out.override_ratio = by_wheel_ ? asked_ratio_ : follower_.override_ratio();
  out.by_spindle = running_ && sample.master.locked;
  out.holds_later = running_ && follower_.holds_later();
  out.off_spindle_mm = out.by_spindle ? sample.master.phase_error : 0.0;
  if (sample.master.underway && sample.master.taps) out.tap_overshoot_mm = sample.master.overshoot;
  out.starved = sample.starved;
  if (sample.starved != starved_ && running_) {
    image::AlarmRecord r;
    r.number = cycle::alarm::kStarved;
    r.process = static_cast<std::int8_t>(config_.index);
    r.line = out.line;
    r.file = out.file;
    r.run = out.run;
    r.value = sample.starved;
    c.notices.add(r);
  }
  starved_ = sample.starved;
  image::Packets& k = c.image.packets;
  k.set_number(at(kMode, base_), static_cast<double>(out.mode));
  k.set_number(at(kState, base_), static_cast<double>(out.state));
  k.set_bit(at(kRunning, base_), running_);
  k.set_bit(at(kHeld, base_), running_ && held_);
  k.set_bit(at(kInPosition, base_), in_position(c));
  k.set_bit(at(kRapid, base_), out.rapid);
  k.set_bit(at(kRetraced, base_), out.retraced);
  k.set_number(at(kLine, base_), out.line);
  k.set_number(at(kFeed, base_), out.feed_mm_s * 60.0);
  k.set_number(at(kOverride, base_), std::round(out.override_ratio * 100.0));
}

}  // namespace servogate::channel
