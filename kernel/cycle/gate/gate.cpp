// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/gate/decision.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/cycle/gate/guarded_places.hpp"
#include "kernel/cycle/gate/interface_places.hpp"

namespace servogate::cycle {

namespace decision {

Answer Decision::run() noexcept {
  const bool known = r_.kind > RequestKind::none && r_.kind <= RequestKind::gear;
  if (!known)
    refuse(Refusal::unknown_request);
  else if (!may_ask(r_.asker).has(r_.kind))
    refuse(Refusal::asker_may_not, -1, static_cast<double>(r_.kind));
  else if (!std::isfinite(r_.value))
    refuse(Refusal::bad_value, -1, r_.value);
  else if (process_known() && mode_of_request())
    decide_kind();
  return answer_;
}

bool Decision::decide_kind() noexcept {
  switch (r_.kind) {
    case RequestKind::power:
      return power();
    case RequestKind::home:
      return home();
    case RequestKind::jog_increment:
    case RequestKind::jog_continuous:
      return jog();
    case RequestKind::keep_alive:
      return keep_alive();
    case RequestKind::reposition:
      return reposition();
    case RequestKind::retrace:
      return retrace();
    case RequestKind::function:
      return function();
    case RequestKind::path_wheel:
      return path_wheel();
    case RequestKind::gear:
      return gear();
    case RequestKind::jog_stop:
      return r_.axis < 0 || axis_known();
    case RequestKind::zero:
      return zero();
    case RequestKind::assign:
      return assign();
    case RequestKind::tables:
      return tables();
    case RequestKind::mode:
      return mode();
    case RequestKind::start:
      return start();
    case RequestKind::step:
      return step();
    case RequestKind::resume:
      return resume();
    case RequestKind::override_feed:
      return (r_.value >= 0.0 && r_.value <= 1.5) || refuse(Refusal::override_range, -1, r_.value, 1.5);
    case RequestKind::set_place:
      return place(true);
    case RequestKind::force:
    case RequestKind::release_force:
      return place(false);
    case RequestKind::logic:
      return r_.value == 1.0 || (no_program() && no_homing() && all_at_rest());
    case RequestKind::logic_scan:
      return logic_scan();
    case RequestKind::axis_power:
    case RequestKind::axis_home:
    case RequestKind::move_absolute:
    case RequestKind::move_relative:
    case RequestKind::move_velocity:
    case RequestKind::torque:
    case RequestKind::axis_stop:
    case RequestKind::axis_reset:
      return auxiliary();
    default:
      return true;  // hold, stop, reset, quick stop, acknowledge: always
  }
}

bool Decision::power() noexcept {
  if (r_.value == 0.0) return true;
  if (!no_alarm(Reaction::stop_on_path)) return false;
  return std::all_of(c_.axes.begin(), c_.axes.end(), [this](const Axis& a) { return not_switching_off(a); });
}

/// A switching-off that has begun comes to its end first.
bool Decision::not_switching_off(const Axis& a) noexcept {
  using State = axis::PowerSequence::State;
  const bool ends = a.letting_go() || a.power_state() == State::engaging;
  return !ends || refuse(Refusal::switching_off, a.index());
}

bool Decision::home() noexcept {
  if (r_.axis != -1 && !axis_known()) return false;
  const double all = std::ldexp(1.0, static_cast<int>(c_.axes.size())) - 1.0;
  if (r_.value < 0.0 || r_.value > all || r_.value != std::floor(r_.value))
    return refuse(Refusal::bad_value, -1, r_.value, all);
  const std::uint32_t mask = homing_mask(r_, c_.axes);
  const bool named = r_.axis >= 0 || r_.value != 0.0;
  if (!no_alarm(Reaction::stop_on_path)) return false;
  for (const Axis& a : c_.axes)
    if ((mask >> a.index() & 1u) != 0 && !no_program_of(a.process())) return false;
  if (!no_homing() || !not_held_by_another()) return false;
  for (const Axis& a : c_.axes) {
    if ((mask >> a.index() & 1u) == 0) continue;
    if (named && a.config().homing.method == axis::HomingMethod::none)
      return refuse(Refusal::no_home_needed, a.index());
    if (!ready(a) || !free(a)) return false;
    if (!a.standstill()) return refuse(Refusal::axis_moves, a.index());
  }
  return true;
}

bool Decision::jog() noexcept {
  if (!axis_known()) return false;
  const Axis& a = c_.axes[static_cast<std::size_t>(r_.axis)];
  const bool continuous = r_.kind == RequestKind::jog_continuous;
  if (r_.value == 0.0 || (continuous && std::abs(r_.value) != 1.0))
    return refuse(Refusal::bad_value, r_.axis, r_.value, 1.0);
  const axis::AxisConfig& config = a.config();
  const double longest = config.travel_limited ? config.travel_max - config.travel_min : kLargestCoordinate;
  if (!continuous && std::abs(r_.value) > longest)
    return refuse(Refusal::jog_range, r_.axis, r_.value, longest);
  if (!no_alarm(Reaction::stop_on_path)) return false;
  if (!(c_.beside.possible ? jog_beside(a) : no_program_of(a.process()))) return false;
  if (!no_homing() || !not_held_by_another()) return false;
  if (!ready(a) || !free(a)) return false;
  const bool forward = r_.value > 0.0;
  // A hand on the other button stops the jog under way, whosever it is; the executive does that.
  const bool against = continuous && a.jogs_on() * r_.value < 0.0;
  if (!against && !in_own_hand(a)) return false;
  if (forward ? a.on_limit_plus() : a.on_limit_minus())
    return refuse(Refusal::on_hard_limit, r_.axis, forward ? 1 : -1);
  if (!a.homed() || !config.travel_limited) return true;
  const double limit = forward ? config.travel_max : config.travel_min, x = a.setpoint().x;
  const bool at_limit = forward ? x >= limit - 1e-9 : x <= limit + 1e-9;
  return !at_limit || refuse(Refusal::at_soft_limit, r_.axis, x, limit);
}

/// The PLC and its own axes: neither a program nor manual control has to do with them.
bool Decision::auxiliary() noexcept {
  if (!axis_known()) return false;
  const Axis& a = c_.axes[static_cast<std::size_t>(r_.axis)];
  if (!a.config().auxiliary) return refuse(Refusal::axis_not_auxiliary, r_.axis);
  const bool ends = r_.kind == RequestKind::axis_stop || r_.kind == RequestKind::axis_reset;
  if (ends || (r_.kind == RequestKind::axis_power && r_.value == 0.0)) return true;
  if (c_.axis_error_stop && r_.kind != RequestKind::axis_power)
    return refuse(Refusal::axis_error_stop, r_.axis);
  if (!no_alarm(Reaction::stop_on_path)) return false;
  if (r_.kind == RequestKind::axis_power)
    return (c_.drives_wanted || refuse(Refusal::drives_not_wanted, r_.axis)) && not_switching_off(a);
  if (c_.axis_stopping) return refuse(Refusal::axis_stopping, r_.axis);
  if (!ready(a)) return false;
  if (a.geared()) return refuse(Refusal::axis_geared, r_.axis);
  if (a.homing().active()) return refuse(Refusal::homing_runs);
  if (r_.kind == RequestKind::torque) return torque(a);
  if (r_.kind != RequestKind::axis_home) return move(a);
  if (a.config().homing.method == axis::HomingMethod::none) return refuse(Refusal::no_home_needed, r_.axis);
  return a.standstill() || refuse(Refusal::axis_moves, r_.axis);
}

bool Decision::move(const Axis& a) noexcept {
  const axis::MotionLimits& most = a.config().limits;
  if (!a.homed()) return refuse(Refusal::not_homed, r_.axis);
  if (a.moving() && !a.plc_moves() && a.owner() != AxisOwner::plc)
    return refuse(Refusal::axis_moves, r_.axis);
  if (!(r_.velocity > 0.0 && r_.velocity <= most.velocity))
    return refuse(Refusal::velocity_range, r_.axis, r_.velocity, most.velocity);
  if (!(r_.acceleration >= 0.0 && r_.acceleration <= most.acceleration))
    return refuse(Refusal::acceleration_range, r_.axis, r_.acceleration, most.acceleration);
  return inside_travel(a);
}

/// The follower begins to move as its master does. A program that moves it rests on it meanwhile.
bool Decision::gear() noexcept {
  if (!axis_known()) return false;
  if (r_.value == 0.0) return true;
  const Axis& a = c_.axes[static_cast<std::size_t>(r_.axis)];
  if (c_.gear == nullptr) return refuse(Refusal::no_gear, r_.axis, r_.value, c_.gears);
  if (!no_alarm(Reaction::stop_on_path)) return false;
  if (a.geared()) return refuse(Refusal::axis_geared, r_.axis);
  if (!a.homed()) return refuse(Refusal::not_homed, r_.axis);
  if (!ready(a)) return false;
  if (a.on_limit_plus() || a.on_limit_minus())
    return refuse(Refusal::on_hard_limit, r_.axis, a.on_limit_plus() ? 1.0 : -1.0);
  if (a.homing().active()) return refuse(Refusal::homing_runs);
  if (a.owner() == AxisOwner::bench)
    return refuse(Refusal::axis_owned, r_.axis, static_cast<double>(a.owner()));
  if (a.moving()) return refuse(Refusal::axis_moves, r_.axis);
  if (const double away = c_.image->axes[static_cast<std::size_t>(r_.axis)].beside; away != 0.0)
    return refuse(Refusal::off_path, r_.axis, away);
  return gear_can_follow(a);
}

bool Decision::gear_can_follow(const Axis& a) noexcept {
  const axis::ElectronicGear& g = *c_.gear;
  if (!g.master_known()) return refuse(Refusal::gear_master, r_.axis);
  const double asked = std::abs(g.speed_asked(c_.axes, c_.spindles)), most = a.config().limits.velocity;
  if (asked > most) return refuse(Refusal::gear_too_fast, r_.axis, asked, most);
  const double off = g.off_place(c_.axes);
  return std::abs(off) <= g.config().window ||
         refuse(Refusal::gear_off_place, r_.axis, off, g.config().window);
}

/// Where the torque takes the axis is not known: it is watched on its way instead.
bool Decision::torque(const Axis& a) noexcept {
  const axis::AxisConfig& config = a.config();
  if (!(config.torque.max > 0.0)) return refuse(Refusal::no_torque, r_.axis);
  if (config.travel_limited && !a.homed()) return refuse(Refusal::not_homed, r_.axis);
  if (a.moving() && a.owner() != AxisOwner::plc) return refuse(Refusal::axis_moves, r_.axis);
  if (!(std::abs(r_.value) <= config.torque.max))
    return refuse(Refusal::torque_range, r_.axis, r_.value, config.torque.max);
  if (!(r_.velocity > 0.0 && r_.velocity <= config.limits.velocity))
    return refuse(Refusal::velocity_range, r_.axis, r_.velocity, config.limits.velocity);
  if (!(r_.acceleration >= 0.0 && r_.acceleration <= config.torque.ramp))
    return refuse(Refusal::torque_ramp_range, r_.axis, r_.acceleration, config.torque.ramp);
  const bool forward = r_.value > 0.0;
  if (forward ? a.on_limit_plus() : r_.value < 0.0 && a.on_limit_minus())
    return refuse(Refusal::on_hard_limit, r_.axis, forward ? 1 : -1);
  if (!config.travel_limited || r_.value == 0.0) return true;
  const double limit = forward ? config.travel_max : config.travel_min, x = a.setpoint().x;
  return (forward ? x < limit : x > limit) || refuse(Refusal::at_soft_limit, r_.axis, x, limit);
}

bool Decision::inside_travel(const Axis& a) noexcept {
  const axis::AxisConfig& config = a.config();
  const double x = a.setpoint().x;
  const bool endless = r_.kind == RequestKind::move_velocity;
  if (endless && std::abs(r_.value) != 1.0) return refuse(Refusal::bad_value, r_.axis, r_.value, 1.0);
  const double way = r_.kind == RequestKind::move_absolute ? r_.value - x : r_.value;
  if (way > 0.0 ? a.on_limit_plus() : way < 0.0 && a.on_limit_minus())
    return refuse(Refusal::on_hard_limit, r_.axis, way > 0.0 ? 1 : -1);
  if (!config.travel_limited) return true;
  const double limit = way > 0.0 ? config.travel_max : config.travel_min;
  if (endless)
    return (way > 0.0 ? x < limit : x > limit) || refuse(Refusal::at_soft_limit, r_.axis, x, limit);
  const bool inside = x + way >= config.travel_min && x + way <= config.travel_max;
  return inside || refuse(Refusal::outside_travel, r_.axis, x + way,
                          x + way > config.travel_max ? config.travel_max : config.travel_min);
}

/// Nobody looks after the machine while the PLC is held: nothing may be on then, or come on (alarm 5004).
bool Decision::logic_scan() noexcept {
  constexpr double kMostScans = 100'000.0;
  if (r_.value == 0.0) return c_.logic_held || refuse(Refusal::logic_not_held);
  if (r_.value == 2.0) {
    if (r_.index < 1 || r_.index > kMostScans) return refuse(Refusal::bad_value, -1, r_.index, kMostScans);
    return c_.logic_held || refuse(Refusal::logic_not_held);
  }
  if (r_.value != 1.0) return refuse(Refusal::bad_value, -1, r_.value, 2.0);
  if (c_.logic_held) return refuse(Refusal::logic_held);
  return no_program() && no_homing() && drives_off();
}

bool Decision::drives_off() noexcept {
  using State = axis::PowerSequence::State;
  for (const Axis& a : c_.axes) {
    if (!a.standstill()) return refuse(Refusal::axis_moves, a.index());
    if (a.power_requested() || a.power_state() != State::off) return refuse(Refusal::drives_on);
  }
  for (int s = 0; s < c_.image->spindle_count; ++s) {
    const image::SpindleImage& spindle = c_.image->spindles[static_cast<std::size_t>(s)];
    if (spindle.running || spindle.command_rpm != 0.0 || spindle.drive_command.power)
      return refuse(Refusal::drives_on);
  }
  return true;
}

/// A continuous jog is its hand's alone: another one neither keeps it alive nor takes it over.
bool Decision::in_own_hand(const Axis& a) noexcept {
  const bool own = c_.image->axes[static_cast<std::size_t>(a.index())].hand == r_.hand();
  return own || a.jogs_on() == 0 || refuse(Refusal::jogged_by_another, a.index());
}

bool Decision::keep_alive() noexcept {
  if (!not_held_by_another()) return false;
  return r_.axis < 0 || (axis_known() && in_own_hand(c_.axes[static_cast<std::size_t>(r_.axis)]));
}

bool Decision::zero() noexcept {
  if (!axis_known()) return false;
  if (std::abs(r_.value) > kLargestCoordinate)
    return refuse(Refusal::zero_range, r_.axis, r_.value, kLargestCoordinate);
  const Axis& a = c_.axes[static_cast<std::size_t>(r_.axis)];
  if (!no_program_of(a.process())) return false;
  if (!free(a)) return false;
  if (!a.homed()) return refuse(Refusal::not_homed, r_.axis);
  return !a.moving() || refuse(Refusal::axis_moves, r_.axis);
}

/// Neither process may have a program under way: what it has planned would meet other axes than it began
/// with.
bool Decision::assign() noexcept {
  if (!axis_known()) return false;
  const Axis& a = c_.axes[static_cast<std::size_t>(r_.axis)];
  if (!no_program_of(a.process()) || !no_program_of(r_.process)) return false;
  if (!no_homing() || !not_held_by_another() || !free(a)) return false;
  for (const axis::Spindle& s : c_.spindles)
    if (s.config().axis == a.index()) return refuse(Refusal::axis_is_spindle, a.index());
  return a.standstill() || refuse(Refusal::axis_moves, r_.axis);
}

/// A program goes by the tables that it began with.
bool Decision::tables() noexcept {
  if (!no_program() || !no_homing()) return false;
  for (const Axis& a : c_.axes) {
    if ((r_.index >> a.index() & 1u) == 0) continue;
    if (a.config().auxiliary) return free(a);
    if (!a.homed()) return refuse(Refusal::not_homed, a.index());
    if (a.moving()) return refuse(Refusal::axis_moves, a.index());
  }
  return true;
}

bool Decision::mode() noexcept {
  const bool valid =
      r_.value >= 0.0 && r_.value <= static_cast<double>(Mode::home) && r_.value == std::floor(r_.value);
  if (!valid) return refuse(Refusal::bad_value, -1, r_.value, static_cast<double>(Mode::home));
  return no_program_of(r_.process) && not_held_by_another();
}

/// A request that brings its mode along is one decision: what would refuse the mode refuses the request.
bool Decision::mode_of_request() noexcept {
  if (r_.mode < 0) return true;
  const bool possible = kWithMode.has(r_.kind) && r_.mode <= static_cast<int>(Mode::home);
  if (!possible) return refuse(Refusal::bad_value, -1, r_.mode, static_cast<double>(Mode::home));
  if (keeps_mode(r_, c_)) return true;
  const bool same = c_.image->processes[static_cast<std::size_t>(r_.process)].mode == mode_in_force();
  return same || runs_on() || (no_program_of(r_.process) && not_held_by_another());
}

/// Held, or waiting for the operator; or about to be held, as long as it moves on its path.
bool Decision::goes_on() const noexcept {
  const ProcessState s = state(r_.process);
  return s == ProcessState::held || s == ProcessState::waiting ||
         (s == ProcessState::running && c_.holding);
}

/// A program that is stepped through may be started to run to its end.
bool Decision::runs_on() const noexcept {
  const ProcessState s = state(r_.process);
  return r_.kind == RequestKind::start && r_.mode == static_cast<int>(Mode::automatic) &&
         (s == ProcessState::held || s == ProcessState::waiting) &&
         c_.image->processes[static_cast<std::size_t>(r_.process)].mode == Mode::step;
}

/// What is planned of a program in AUTO goes on to its end: a step would be all of it.
bool Decision::step() noexcept {
  if (goes_on() && c_.image->processes[static_cast<std::size_t>(r_.process)].mode != Mode::step)
    return refuse(Refusal::not_stepping);
  return start();
}

bool Decision::start() noexcept {
  const ProcessState s = state(r_.process);
  // A hold, M00 and the end of a block in STEP go on by the same button.
  if (goes_on()) return resume();
  if (busy(s)) return under_way(r_.process);
  if (!c_.program_loaded) return refuse(Refusal::no_program);
  if (!c_.start_permitted) return refuse(Refusal::start_not_permitted);
  const Mode m = mode_in_force();
  if (m >= Mode::manual) return refuse(Refusal::wrong_mode, -1, static_cast<double>(m));
  if (!no_alarm(Reaction::stop_at_block_end) || !no_homing() || !not_held_by_another()) return false;
  for (const Axis& a : c_.axes) {
    if (!of_process(a) || a.asleep()) continue;
    if (!a.homed()) return refuse(Refusal::not_homed, a.index());
    // A program knows no slow way off a switch: that is jogging's.
    if (a.on_limit_plus() || a.on_limit_minus())
      return refuse(Refusal::on_hard_limit, a.index(), a.on_limit_plus() ? 1.0 : -1.0);
    if (!ready(a) || !free(a)) return false;
    if (a.owner() != AxisOwner::process && a.moving()) return refuse(Refusal::axis_moves, a.index());
  }
  return true;
}

bool Decision::resume() noexcept {
  const ProcessState s = state(r_.process);
  if (!busy(s)) return refuse(Refusal::program_does_not_run, -1, r_.process);
  if ((c_.stopping >> r_.process & 1u) != 0) return under_way(r_.process);
  if (!goes_on()) return refuse(Refusal::program_not_held, -1, r_.process);
  // Behind an open door nothing is begun that its closing would let go.
  for (const Axis& a : c_.axes)
    if (of_process(a) && !a.asleep() && !feed_enabled(a)) return false;
  if (!no_alarm(Reaction::stop_at_block_end) || !no_homing() || !not_held_by_another()) return false;
  if (s == ProcessState::running) return true;  // on its path, where it slows down
  for (const Axis& a : c_.axes)
    if (of_process(a) && a.moving()) return refuse(Refusal::axis_moves, a.index());
  return as_it_was_held();
}

/// The chain and what is made of it are shown as they are, whoever asks.
bool Decision::not_of_emergency_stop(const image::Place& place) noexcept {
  const bool chain = c_.estop_place != nullptr && c_.estop_place->overlaps(place);
  return !(chain || places::kEstopOk.overlaps(place)) || refuse(Refusal::emergency_stop_place);
}

/// Whoever puts a guard out of force, or back, does it where nothing moves: either may let something go.
bool Decision::may_force(const image::Place& place) noexcept {
  const bool guard = guards_motion(place, {c_.image->process_count, c_.axes, c_.spindles});
  return !guard || (at_standstill() && not_held_by_another());
}

/// Nothing moves, and nothing is ordered that a permission would let move.
bool Decision::at_standstill() noexcept {
  for (int p = 0; p < c_.image->process_count; ++p)
    if (busy(state(p)) || (c_.stopping >> p & 1u) != 0) return refuse(Refusal::guard_program, -1, p);
  if (c_.homing_runs) return refuse(Refusal::guard_homing);
  for (const Axis& a : c_.axes)
    if (a.moving()) return refuse(Refusal::guard_axis, a.index());
  for (int s = 0; s < c_.image->spindle_count; ++s) {
    const image::SpindleImage& spindle = c_.image->spindles[static_cast<std::size_t>(s)];
    if (spindle.running || spindle.command_rpm != 0.0) return refuse(Refusal::guard_spindle, -1, s);
  }
  return true;
}

bool Decision::place(bool write) noexcept {
  if (r_.packet > static_cast<int>(image::Packet::v) || r_.format > static_cast<int>(image::Format::ch))
    return refuse(Refusal::bad_value, -1, r_.packet);
  const image::Place p{static_cast<image::Packet>(r_.packet), static_cast<image::Format>(r_.format), r_.index,
                       r_.length};
  // In 64 bits: an index near the end of its range must not wrap round into the packet.
  const std::uint64_t first =
      p.format == image::Format::bl ? p.index / 8 : std::uint64_t{p.index} * image::format_size(p.format);
  const std::uint64_t end = first + p.bytes();
  const std::uint32_t size = c_.image->packets.size(p.packet);
  if (end > size) return refuse(Refusal::place_outside, -1, static_cast<double>(first), size);
  if (!write) return (r_.kind != RequestKind::force || not_of_emergency_stop(p)) && may_force(p);
  constexpr std::uint32_t kInterfaceEnd = image::kMachineBase + image::kMachineBlock;
  bool interface = p.packet == image::Packet::k && first < kInterfaceEnd && end > image::kInterfaceBase;
  for (const Axis& a : c_.axes) {
    const std::uint32_t base = image::motion_base(a.index());
    interface = interface || (a.config().auxiliary && p.packet == image::Packet::k &&
                              first < base + image::kMotionBlock && end > base);
  }
  const bool signal = p.packet == image::Packet::a && r_.asker != Asker::scenario;
  return !(interface || signal) || refuse(Refusal::place_not_writable, -1, static_cast<double>(first));
}

}  // namespace decision

using axis::Axis;
using image::Answer;
using image::Request;
using image::RequestKind;
using requests::kBegins;
using requests::kTakesAway;
using requests::kTakesAwayAtZero;

std::uint32_t homing_mask(const Request& request, std::span<const Axis> axes) noexcept {
  if (request.axis >= 0) return 1u << request.axis;
  if (request.value > 0.0) return static_cast<std::uint32_t>(request.value);
  std::uint32_t mask = 0;
  for (const Axis& a : axes)
    if (!a.config().auxiliary && !a.asleep()) mask |= 1u << a.index();
  return mask;
}

Answer decide(const Request& request, const GateContext& context) noexcept {
  return decision::Decision(request, context).run();
}

int beside_process(const Request& request, std::span<const Axis> axes) noexcept {
  const bool of_axis =
      requests::kJogs.has(request.kind) && request.axis >= 0 && request.axis < std::ssize(axes);
  return of_axis ? axes[static_cast<std::size_t>(request.axis)].process() : request.process;
}

bool keeps_mode(const Request& request, const GateContext& context) noexcept {
  return requests::kJogs.has(request.kind) && context.beside.possible;
}

bool moves(RequestKind kind) noexcept { return kBegins.has(kind); }

bool never_too_old(const Request& request) noexcept {
  return kTakesAway.has(request.kind) || (kTakesAwayAtZero.has(request.kind) && request.value == 0.0);
}

}  // namespace servogate::cycle
