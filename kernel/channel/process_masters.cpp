// SPDX-License-Identifier: Apache-2.0
// Motions by the spindle's angle, and the probe.
#include <cmath>
#include <utility>

#include "kernel/channel/alarms/master_alarms.hpp"
#include "kernel/channel/process.hpp"

namespace servogate::channel {
namespace {

image::AlarmNumber alarm_of(path::MasterFault fault) noexcept {
  switch (fault) {
    case path::MasterFault::lost:
      return alarm::kThreadMasterLost;
    case path::MasterFault::reversed:
      return alarm::kThreadMasterTurned;
    case path::MasterFault::window:
      return alarm::kThreadWindow;
    case path::MasterFault::too_fast:
      return alarm::kThreadTooFast;
    case path::MasterFault::too_short:
      return alarm::kThreadTooShort;
    case path::MasterFault::none:
      break;
  }
  return 0;
}

axis::SpindleMode turning(program::SpindleMode mode) noexcept {
  return mode == program::SpindleMode::cw    ? axis::SpindleMode::cw
         : mode == program::SpindleMode::ccw ? axis::SpindleMode::ccw
                                             : axis::SpindleMode::stop;
}

}  // namespace

/// The spindle as its encoder shows it, and when the set-point of this cycle is where the axes are.
path::MasterReading Process::master(const cycle::ProcessContext& c) const noexcept {
  path::MasterReading reading;
  const axis::Spindle* turns = spindle(0, c);
  if (turns == nullptr) return reading;
  const axis::SpindleAngle& angle = turns->angle();
  reading.valid = angle.valid;
  reading.ready = turns->at_speed();
  reading.turns = angle.turns;
  reading.part = angle.part;
  reading.at_ns = angle.at_ns;
  reading.braking = turns->config().acceleration / 60.0;
  const int delay = own_count_ > 0 ? c.axes[own_[0].machine].config().feedback_delay : 2;
  reading.acts_ns = c.image.now.t_ns + (delay - 1) * c.image.now.period_ns;
  return reading;
}

/// About the block in motion.
void Process::raise_of_motion(image::AlarmNumber number, double value, double limit,
                              cycle::ProcessContext& c) noexcept {
  Event at;
  at.line = shown_.line;
  at.file = static_cast<std::int16_t>(shown_.file);
  at.block = shown_.block;
  raise(number, at, value, limit, c);
}

void Process::follow_master(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  const path::ByMaster& master = sample.master;
  if (!master.underway) {
    if (tap_turned_) tap_overshoot_ = master.overshoot;
    master_told_ = tap_turned_ = tap_halted_ = false;
    return;
  }
  axis::Spindle* turns = spindle(0, c);
  if (!master_told_ && !stopping_) {
    const bool blind = turns == nullptr || turns->config().inverter || !turns->config().encoder;
    master_told_ = blind || master.leaving;
    if (blind)
      raise_of_motion(alarm::kThreadNoEncoder, 0.0, 0.0, c);
    else if (master.fault != path::MasterFault::none)
      raise_of_motion(alarm_of(master.fault), master.value, master.limit, c);
    else if (master.leaving)
      raise_of_motion(alarm::kThreadHeld, 0.0, 0.0, c);
  }
  if (turns == nullptr) return;
  if (master.halt && !tap_halted_) {
    tap_halted_ = true;
    turns->order(axis::SpindleMode::stop, 0.0);
  } else if (master.reverse && !tap_turned_ && !tap_halted_) {
    tap_turned_ = true;
    turns->order(turning(tap_.mode), tap_.value > 0.0 ? tap_.value : turns->ordered_rpm());
  }
}

/// In the cycle in which the angle passes a whole revolution, as of the time when a set-point acts.
bool Process::passes_mark(const Event& e, cycle::ProcessContext& c) noexcept {
  const path::MasterReading now = master(c);
  const axis::Spindle* turns = spindle(e.number, c);
  if (stage_ == Stage::entered) {
    mark_ = -1.0;
    if (turns == nullptr || turns->config().inverter || !turns->config().encoder)
      raise(alarm::kThreadNoEncoder, e, 0.0, 0.0, c);
  }
  stage_ = Stage::waiting;
  if (turns == nullptr || !now.valid || !now.ready) return false;
  const double ahead = static_cast<double>(now.acts_ns - now.at_ns) * 1e-9 * turns->actual_rpm() / 60.0;
  const double angle = now.part + ahead, part = angle - std::floor(angle),
               before = std::exchange(mark_, part);
  return before >= 0.0 && std::abs(part - before) > 0.5;
}

/// False: the path does not go on.
bool Process::arm_probe(const Event& e, cycle::ProcessContext& c) noexcept {
  if (stage_ == Stage::waiting) return false;
  if (!probing_.present() || probing_.deflected()) {
    raise(probing_.present() ? alarm::kProbeStuck : alarm::kProbeNone, e, 0.0, 0.0, c);
    stage_ = Stage::waiting;
    return false;
  }
  probing_.arm();
  return true;
}

/// The motion ends where the probe touches; what it had still to go is dropped, and the feeder goes on from
/// where it rests.
void Process::watch_probe(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  if (!running_ || stopping_) return;
  if (!probing_.armed()) {
    if (probing_.has_touched() && sample.rapid && sample.feed > 0.0)
      raise_of_motion(alarm::kProbeInRapid, 0.0, 0.0, c);
    return;
  }
  if (!probing_.touched()) return;
  if (sample.state != path::FollowerState::stopped) return follower_.stop();
  if (!probing_.known() || events_read_ >= events_end_) return;
  link_.events.free_below(++events_read_);  // of the end that was not reached
  FeederOrder order;
  order.kind = FeederOrder::Kind::probed;
  order.generation = generation_;
  for (std::size_t a = 0; a < c.axes.size(); ++a) order.position[a] = c.image.axes[a].command;
  for (const OwnAxis& own : own_axes()) order.position[own.machine] = sample.position[own.path];
  order.touched = probing_.at();
  link_.orders.push(order);
  probing_.disarm();
}

}  // namespace servogate::channel
