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
    case path::MasterFault::stands:
      return alarm::kThreadSpindleStands;
    case path::MasterFault::overshoot:
      return alarm::kTapTooDeep;
    case path::MasterFault::no_turn:
      return alarm::kTapNoTurn;
    case path::MasterFault::starved:
      return alarm::kThreadStarved;
    case path::MasterFault::none:
      break;
  }
  return 0;
}

/// Whatever else stops the program: the tap may have broken in the part.
bool always_told(path::MasterFault fault) noexcept {
  return fault == path::MasterFault::overshoot || fault == path::MasterFault::no_turn;
}

constexpr double kProbeLate = 0.01;  // s in which a touch at the end of its motion may still come
constexpr double kProbeCalms = 1.0;  // s
constexpr double kProbeArms = 0.1;   // s in which a drive surely has its order to latch

}  // namespace

/// The spindle as its encoder shows it, and when the set-point of this cycle is where the axes are.
path::MasterReading Process::master(const cycle::ProcessContext& c) const noexcept {
  path::MasterReading reading;
  const axis::Spindle* turns = spindle(0, c);
  if (turns == nullptr) return reading;
  const axis::SpindleAngle& angle = turns->angle();
  reading.valid = angle.valid;
  reading.ready = turns->at_speed();
  const bool told = turns->mode() == axis::SpindleMode::cw || turns->mode() == axis::SpindleMode::ccw;
  reading.ordered = told ? turns->ordered_rpm() / 60.0 : 0.0;
  reading.turns = angle.turns;
  reading.part = angle.part;
  reading.at_ns = angle.at_ns;
  reading.by_setpoint = turns->config().thread_by_setpoint;
  reading.setpoint_ahead = turns->setpoint_ahead();
  reading.braking = turns->config().acceleration / 60.0;
  const int delay = own_count_ > 0 ? c.axes[own_[0].machine].config().feedback_delay : 2;
  reading.acts_ns = c.image.now.t_ns + (delay - 1) * c.image.now.period_ns;
  return reading;
}

/// About the block in motion.
void Process::raise_of_motion(image::AlarmNumber number, double value, double limit, cycle::ProcessContext& c,
                              int axis) noexcept {
  Event at;
  at.line = shown_.line;
  at.file = static_cast<std::int16_t>(shown_.file);
  at.block = shown_.block;
  raise(number, at, value, limit, c, axis);
}

/// The program cannot move an axis that follows a master, nor one that has left the path with it.
void Process::watch_geared(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  for (std::size_t i = 0; i < config_.axes.machine.size() && !taken_told_ && !stopping_; ++i) {
    const int a = config_.axes.machine[i];
    const axis::Axis& axis = c.axes[static_cast<std::size_t>(a)];
    const bool taken = axis.geared() || (taken_ >> a & 1u) != 0;
    if (!taken || axis.process() != config_.index || sample.velocity[i] == 0.0) continue;
    taken_told_ = true;
    raise_of_motion(alarm::kGearedAxis, 0.0, 0.0, c, a);
  }
}

void Process::follow_master(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  const path::ByMaster& master = sample.master;
  on_master_ = master.underway;
  if (!master.underway) {
    if (tapping_) tap_overshoot_ = master.overshoot;
    master_told_ = tapping_ = false;
    return;
  }
  axis::Spindle* turns = spindle(0, c);
  tell_of_master(master, turns, c);
  if (turns == nullptr || !master.taps) return;
  if (!tapping_) {
    tapping_ = true;
    tap_halted_ = false;
    tap_turn_ = 0;
    tap_rpm_ = turns->ordered_rpm();
  }
  order_tap(master, *turns);
}

void Process::tell_of_master(const path::ByMaster& master, const axis::Spindle* turns,
                             cycle::ProcessContext& c) noexcept {
  if (master_told_ || (stopping_ && !always_told(master.fault))) return;
  const bool blind = turns == nullptr || turns->config().inverter || !turns->config().encoder;
  master_told_ = blind || master.leaving;
  if (blind)
    raise_of_motion(alarm::kThreadNoEncoder, 0.0, 0.0, c);
  else if (master.fault != path::MasterFault::none)
    raise_of_motion(alarm_of(master.fault), master.value, master.limit, c);
  else if (master.leaving)
    raise_of_motion(alarm::kThreadHeld, 0.0, 0.0, c);
}

void Process::order_tap(const path::ByMaster& master, axis::Spindle& turns) noexcept {
  if (master.halt) {
    if (!tap_halted_) turns.order(axis::SpindleMode::stop, 0.0);
  } else if (master.turn != 0 && master.turn != tap_turn_) {
    tap_turn_ = master.turn;
    turns.order(master.turn > 0 ? axis::SpindleMode::cw : axis::SpindleMode::ccw,
                master.turn_rpm > 0.0 ? master.turn_rpm : tap_rpm_);
  }
  tap_halted_ = master.halt;
}

/// The path goes on when they are in step, or as long as the first one is not to turn.
bool Process::couple_spindles(const Event& e, cycle::ProcessContext& c) noexcept {
  const axis::Spindle* leader = spindle(0, c);
  axis::Spindle* follower = spindle(e.number, c);
  if (leader == nullptr || follower == nullptr) return true;
  if (!e.flag) {
    follower->uncouple();
    return true;
  }
  if (stage_ == Stage::entered) follower->couple({e.code, e.code2, e.angle});
  stage_ = Stage::waiting;
  return out_of_step(c) == nullptr;
}

/// At rest: the path goes on with the axis where it knows it to stand.
bool Process::change_spindle(const Event& e, cycle::ProcessContext& c) noexcept {
  axis::Spindle* turns = spindle(0, c);
  if (turns == nullptr || turns->config().axis < 0) return true;
  axis::Axis& a = c.axes[static_cast<std::size_t>(turns->config().axis)];
  if (stage_ == Stage::entered) {
    surface_speed_ = 0.0;
    if (!e.flag) a.release(image::AxisOwner::process);
    turns->want_axis(e.flag);
  }
  stage_ = Stage::waiting;
  return e.flag ? turns->is_axis() && a.acquire(image::AxisOwner::process) : turns->is_spindle();
}

/// What a program has made an axis is a spindle at rest behind it.
void Process::return_spindles(cycle::ProcessContext& c) noexcept {
  for (axis::Spindle& s : c.spindles)
    if (s.config().process == config_.index) s.want_axis(false);
}

/// An axis whose drive is a spindle's, or goes from one to the other.
bool Process::is_spindle(int axis, const cycle::ProcessContext& c) noexcept {
  for (const axis::Spindle& s : c.spindles)
    if (s.config().axis == axis) return !s.is_axis() || !s.wants_axis();
  return false;
}

/// The spindle that follows and is not in step while the first one is to turn; nullptr: there is none.
const axis::Spindle* Process::out_of_step(const cycle::ProcessContext& c) const noexcept {
  const axis::Spindle* leader = spindle(0, c);
  if (leader == nullptr || leader->ordered_rpm() == 0.0) return nullptr;
  if (leader->mode() != axis::SpindleMode::cw && leader->mode() != axis::SpindleMode::ccw) return nullptr;
  for (const axis::Spindle& s : c.spindles)
    if (s.config().process == config_.index && s.coupled() && !s.synchronous()) return &s;
  return nullptr;
}

/// Both spindles come down together: the cutter neither stands in a part that turns, nor is it still coupled
/// to the next program.
void Process::end_couplings(cycle::ProcessContext& c) noexcept {
  for (const axis::Spindle& s : c.spindles)
    if (s.config().process == config_.index && s.coupled()) return stop_spindles(c);
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

/// False: the path does not go on. A probe that has just come free may still bounce.
bool Process::arm_probe(const Event& e, cycle::ProcessContext& c) noexcept {
  if (stage_ == Stage::entered) {
    waited_s_ = 0.0;
    if (probing_.latch())
      for (const OwnAxis& own : own_axes())
        c.axes[own.machine].arm_probe(*probing_.latch(), probing_.inverted());
  }
  stage_ = Stage::waiting;
  if (probe_told_) return false;
  waited_s_ += seconds(c);
  if (probing_.latch() && waited_s_ < kProbeArms) return false;
  const bool bounces = probing_.present() && !probing_.settled();
  if (bounces && waited_s_ < kProbeCalms) return false;
  bool early = false;  // the drives keep the first edge: it must be that of the touch
  if (probing_.latch())
    for (const OwnAxis& own : own_axes()) early = early || c.axes[own.machine].probe_latched();
  if (!probing_.present() || probing_.deflected() || bounces || early) {
    raise(probing_.present() ? alarm::kProbeStuck : alarm::kProbeNone, e, 0.0, 0.0, c);
    probe_told_ = true;
    return false;
  }
  probing_.arm(own_mask());
  return true;
}

std::uint32_t Process::own_mask() const noexcept {
  std::uint32_t mask = 0;
  for (const OwnAxis& own : own_axes()) mask |= std::uint32_t{1} << own.machine;
  return mask;
}

void Process::disarm_drives(cycle::ProcessContext& c) noexcept {
  for (const OwnAxis& own : own_axes()) c.axes[own.machine].disarm_probe();
}

/// At the end of a measuring motion: a touch in the cycle of the arrival is one, and its edge may come later.
bool Process::miss_probe(const Event& e, cycle::ProcessContext& c) noexcept {
  if (stage_ == Stage::entered) waited_s_ = 0.0;
  stage_ = Stage::waiting;
  if (probe_told_ || probing_.touched()) return false;
  waited_s_ += seconds(c);
  if (waited_s_ <= kProbeLate) return false;
  raise(alarm::kProbeMissed, e, 0.0, 0.0, c);
  probe_told_ = true;
  return false;
}

/// Outside of measuring motions.
void Process::watch_idle_probe(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  if (probe_told_) return;
  if (probing_.stuck()) {
    raise_of_motion(alarm::kProbeNotFree, probing_.away(), Probing::kRelease, c);
    probe_told_ = true;
  } else if (probing_.has_touched() && sample.rapid && sample.feed > 0.0) {
    raise_of_motion(alarm::kProbeInRapid, 0.0, 0.0, c);
    probe_told_ = true;
  }
}

/// The motion ends where the probe touches; what it had still to go is dropped, and the feeder goes on from
/// where it rests.
void Process::watch_probe(const path::Sample& sample, cycle::ProcessContext& c) noexcept {
  if (!running_ || stopping_) return;
  if (!probing_.armed()) return watch_idle_probe(sample, c);
  if (!probing_.touched()) return;
  if (sample.state != path::FollowerState::stopped) return follower_.stop();
  if (!probing_.known()) {
    if (probing_.unlatched() >= 0 && !probe_told_) {
      raise_of_motion(alarm::kProbeNotLatched, 0.0, Probing::kLatchPatience, c, probing_.unlatched());
      probe_told_ = true;
    }
    return;
  }
  // The event of the end that was not reached goes; one that had begun ends.
  if (stage_ != Stage::none && event_.kind == EventKind::probe_end)
    stage_ = Stage::none;
  else if (events_read_ < events_end_)
    link_.events.free_below(++events_read_);
  else
    return;
  FeederOrder order;
  order.kind = FeederOrder::Kind::probed;
  order.generation = generation_;
  for (std::size_t a = 0; a < c.axes.size(); ++a) order.position[a] = c.image.axes[a].command;
  for (const OwnAxis& own : own_axes()) order.position[own.machine] = sample.position[own.path];
  order.touched = probing_.at();
  link_.orders.push(order);
  probing_.disarm();
  disarm_drives(c);
}

}  // namespace servogate::channel
