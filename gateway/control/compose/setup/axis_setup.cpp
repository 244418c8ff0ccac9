// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/setup/axis_setup.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gateway/control/compose/alarms/source_names.hpp"
#include "machine/consequences.hpp"

namespace servogate::gateway {

namespace {

int sign(machine::Direction d) { return d == machine::Direction::plus ? 1 : -1; }

axis::HomingMethod method(machine::HomingMethod m) {
  switch (m) {
    case machine::HomingMethod::switch_and_index:
      return axis::HomingMethod::switch_and_index;
    case machine::HomingMethod::switch_only:
      return axis::HomingMethod::switch_only;
    case machine::HomingMethod::index:
      return axis::HomingMethod::index_only;
    case machine::HomingMethod::drive:
      return axis::HomingMethod::drive;
    case machine::HomingMethod::absolute:
      return axis::HomingMethod::absolute;
    case machine::HomingMethod::none:
      return axis::HomingMethod::none;
  }
  return axis::HomingMethod::none;
}

/// Whether a method of CiA 402-2 turns round at a limit switch, or has one for its home.
bool turns_at_limit(int method) {
  const int without_index = method > 16 && method < 31 ? method - 16 : method;
  return without_index == 1 || without_index == 2 || (without_index >= 7 && without_index <= 14) ||
         method < 0;
}

axis::HomingData homing(const machine::MachineConfig& m, const machine::AxisConfig& a) {
  axis::HomingData h;
  h.method = method(a.home.method);
  h.direction = sign(a.home.direction);
  h.release_direction = sign(a.home.index_direction);
  if (a.home.fast > 0.0) h.fast = a.home.fast;
  if (a.home.slow > 0.0) h.slow = a.home.slow;
  h.position = a.home.position;
  h.final_move = a.home.final_move;
  h.final_position = a.home.final_position;
  h.max_travel = a.home.max_travel > 0.0 ? a.home.max_travel : 1.2 * (a.travel_max - a.travel_min);
  h.max_index_travel = a.home.index_max_travel > 0.0
                           ? a.home.index_max_travel
                           : 1.5 * a.lead * static_cast<double>(a.gear[1]) / static_cast<double>(a.gear[0]);
  // The ramp down from the search and up again, and a second for what the switch takes.
  if (turns_at_limit(a.home.drive_method)) h.drive_limit_time = 2.0 * h.fast / a.homing_acceleration() + 1.0;
  h.timeout_s = a.home.timeout;
  h.order = a.home.order;
  if (const machine::PointConfig* p = m.point(a.home.switch_point); p != nullptr) h.edges = p->edges;
  h.index_spacing = a.lead * static_cast<double>(a.gear[1]) / static_cast<double>(a.gear[0]);
  return h;
}

std::optional<axis::SwitchPlace> switch_place(const machine::MachineConfig& m, const std::string& point) {
  const machine::PointConfig* p = point.empty() ? nullptr : m.point(point);
  if (p == nullptr) return std::nullopt;
  return axis::SwitchPlace{p->place, false};
}

/// Exact ratio counts : units from whole counts, a gear of whole numbers, and a lead known to 1e-6.
void exact_ratio(std::int64_t counts, std::int64_t gear_motor, std::int64_t gear_screw, double lead,
                 std::int64_t& numerator, std::int64_t& denominator) {
  constexpr std::int64_t kLeadSteps = 1'000'000;
  std::int64_t lead_steps = std::llround(lead * kLeadSteps);
  std::int64_t steps = kLeadSteps;
  const std::int64_t common = std::gcd(lead_steps, steps);
  lead_steps /= common;
  steps /= common;
  numerator = counts * gear_motor * steps;
  denominator = gear_screw * lead_steps;
  const std::int64_t divisor = std::gcd(numerator, denominator);
  numerator /= divisor;
  denominator /= divisor;
}

/// The outputs of an inverter; nothing when a drive supplies the spindle.
std::optional<axis::InverterConfig> inverter(const machine::MachineConfig& m,
                                             const machine::SpindleConfig& s) {
  axis::InverterConfig c;
  const auto place = [&](const std::string& name) -> std::optional<image::Place> {
    int station = -1;
    const machine::PointConfig* p = name.empty() ? nullptr : m.point(name, &station);
    if (p == nullptr) return std::nullopt;
    if (station < image::kMaxSources) c.sources |= std::uint32_t{1} << station;
    return p->place;
  };
  const auto speed = place(s.speed_output);
  if (!speed) return std::nullopt;
  c.speed = *speed;
  c.cw = place(s.cw_output);
  c.ccw = place(s.ccw_output);
  return c;
}

axis::GearboxConfig gearbox(const machine::MachineConfig& m, const machine::SpindleConfig& s) {
  axis::GearboxConfig c;
  c.change_rpm = s.gear_change_speed;
  c.change_s = s.gear_change_time;
  c.timeout_s = s.gear_change_timeout;
  const auto place = [&](const std::string& name) -> std::optional<image::Place> {
    int station = -1;
    const machine::PointConfig* p = name.empty() ? nullptr : m.point(name, &station);
    if (p == nullptr) return std::nullopt;
    if (station < image::kMaxSources) c.sources |= std::uint32_t{1} << station;
    return p->place;
  };
  // An analog output is told the speed of the motor itself, a drive or an inverter as if in the first gear.
  const double first = s.speed_output.empty() && !s.gears.empty() ? s.gears.front().ratio() : 1.0;
  for (const machine::GearConfig& g : s.gears)
    c.ranges.push_back({g.max_speed, g.ratio() / first, place(g.output), place(g.confirm)});
  return c;
}

/// What a spindle on an inverter has instead of a drive on a bus.
void put_inverter(const machine::LoadResult& loaded, const machine::SpindleConfig& s,
                  axis::SpindleConfig& c) {
  const std::vector<machine::StationConfig>& stations = loaded.machine.stations;
  for (std::size_t n = 0; n < stations.size(); ++n) {
    if (s.inverter.empty() || stations[n].name != s.inverter) continue;
    c.source = static_cast<int>(n);
    c.counts_numerator = kInverterCounts;
    c.loss_reaction = loss_reaction(s.loss_reaction);
    if (const machine::DeviceConfig* device = loaded.device(stations[n].device); device != nullptr) {
      c.reverses = device->inverter.reverse >= 0;
      c.target_bit = device->inverter.at_speed[0] != 0;
    }
  }
}

/// Cycles without an answer of a board: it counts as gone after half of its watchdog, so this is never
/// reached.
std::uint32_t missed_limit(const machine::MachineConfig& m, const std::string& board) {
  constexpr std::uint32_t kFewest = 2;
  for (const machine::StationConfig& s : m.stations)
    if (s.name == board)
      return std::max(kFewest, static_cast<std::uint32_t>(s.watchdog / m.control.cycle_time));
  return kFewest;
}

image::PartPlace drive_place(const machine::MachineConfig& m, std::string_view reference) {
  int bus = -1;
  const machine::NodeConfig* node = m.node(reference, &bus);
  if (node == nullptr) return {};
  return {static_cast<std::int16_t>(bus), static_cast<std::int16_t>(node->id)};
}

}  // namespace

image::Reaction loss_reaction(machine::LossReaction reaction) {
  switch (reaction) {
    case machine::LossReaction::stop_axes:
      return image::Reaction::stop_axes;
    case machine::LossReaction::stop_and_power_off:
      return image::Reaction::stop_and_power_off;
    case machine::LossReaction::quick_stop:
      return image::Reaction::quick_stop;
    case machine::LossReaction::power_off:
      return image::Reaction::power_off;
    case machine::LossReaction::stop_on_path:
      break;
  }
  return image::Reaction::stop_on_path;
}

axis::AxisConfig axis_config(const machine::LoadResult& loaded, const machine::AxisConfig& a) {
  const machine::MachineConfig& m = loaded.machine;
  axis::AxisConfig c;
  c.process = a.process - 1;
  c.rotary = a.type == machine::AxisType::rotary;
  c.auxiliary = a.auxiliary;
  exact_ratio(a.counts_per_rev, a.gear[0], a.gear[1], a.lead, c.counts_numerator, c.counts_denominator);
  c.count_direction = sign(a.direction);
  c.limits = {a.max_velocity, a.max_acceleration, a.max_jerk};
  c.travel_limited = !a.endless();
  c.travel_min = a.travel_min;
  c.travel_max = a.travel_max;
  if (a.following_error_stop > 0.0) c.following_error_limit = a.following_error_stop;
  c.following_error_warn = a.following_error_warn;
  c.following_error_velocity = a.following_error_velocity;
  c.in_position_window = a.in_position_window;
  c.in_position_time = a.in_position_time;
  c.in_position_timeout = a.in_position_timeout;
  c.homing = homing(m, a);
  c.limit_plus = switch_place(m, a.limit_plus);
  c.limit_minus = switch_place(m, a.limit_minus);
  c.home_switch = switch_place(m, a.home.switch_point);
  c.backlash = a.backlash;
  for (const auto& point : a.pitch_table) c.pitch.push_back({point[0], point[1], point[1]});
  if (a.brake.present()) {
    c.brake.output = a.brake.drive_output ? axis::BrakeOutput::drive : axis::BrakeOutput::place;
    if (const machine::PointConfig* p = m.point(a.brake.point); p != nullptr) c.brake.place.place = p->place;
    c.brake.command_time = machine::brake_command_time(loaded, a);
    c.brake.torque_delay = a.brake.torque_delay;
    c.brake.slip_window = a.brake.slip_window;
    c.brake.release_delay = a.brake.release_delay;
    c.brake.engage_delay = a.brake.engage_delay;
  }
  c.torque = {a.torque_max, a.greatest_torque_ramp()};
  c.jog_velocity = a.jog();
  c.slow_velocity = a.jog_not_homed();
  c.drive = drive_place(m, a.drive);
  if (const machine::NodeConfig* node = m.node(a.drive); node != nullptr) {
    // A target of cycle k leaves in k, acts at SYNC k + 1 and is read back one cycle after it was latched.
    if (const machine::DeviceConfig* device = loaded.device(node->device); device != nullptr)
      c.feedback_delay = 2 + device->behaviour.command_delay;
    c.missed_limit = static_cast<std::uint32_t>(node->loss_cycles);
    // Its values come when they come; the segment knows when an answer is overdue.
    if (const machine::DeviceConfig* device = loaded.device(node->device);
        device != nullptr && device->behaviour.sdo_only)
      c.missed_limit = 0;
    c.loss_reaction = loss_reaction(node->loss_reaction);
  }
  if (a.board.present()) c.drive = board_place(m, a.board);
  if (a.board.present()) c.missed_limit = missed_limit(m, a.board.station);
  return c;
}

std::int64_t counts_per_motor_turn(const machine::SpindleConfig& s) {
  return std::llround(static_cast<double>(s.counts_per_rev) * static_cast<double>(s.first_gear()[1]) /
                      static_cast<double>(s.first_gear()[0]));
}

axis::SpindleConfig spindle_config(const machine::LoadResult& loaded, const machine::SpindleConfig& s) {
  axis::SpindleConfig c;
  c.process = s.process - 1;
  c.drive = drive_place(loaded.machine, s.drive);
  c.inverter = inverter(loaded.machine, s);
  c.gearbox = gearbox(loaded.machine, s);
  c.encoder = s.has_encoder();
  put_inverter(loaded, s, c);
  if (s.has_encoder()) {
    c.counts_numerator = s.counts_per_rev;
    c.counts_denominator = 1;
  } else if (const machine::NodeConfig* node = loaded.machine.node(s.drive); node != nullptr) {
    // The drive counts at its motor.
    const machine::DeviceConfig* device = loaded.device(node->device);
    if (device != nullptr && device->motor.counts_per_rev > 0)
      exact_ratio(device->motor.counts_per_rev, s.first_gear()[0], s.first_gear()[1], 1.0, c.counts_numerator,
                  c.counts_denominator);
  }
  c.encoder_delay = s.encoder_delay;
  c.count_direction = sign(s.direction);
  c.max_rpm = s.max_speed;
  c.min_rpm = s.min_speed;
  c.acceleration = s.acceleration;
  c.at_speed_window = s.at_speed_window / 100.0;
  c.at_speed_timeout = s.at_speed_timeout;
  c.orient_angle = s.orient_angle;
  c.orient_rpm = s.orient_speed;
  c.thread_by_setpoint = s.thread_master == machine::ThreadMaster::setpoint;
  c.coupling = static_cast<axis::CouplingBy>(s.coupling);
  c.coupling_window = s.coupling_window;
  c.axis = loaded.machine.axis_index(s.axis);
  return c;
}

axis::ElectronicGearConfig gear_config(const machine::MachineConfig& m,
                                       const machine::ElectronicGearConfig& g) {
  axis::ElectronicGearConfig c;
  c.follower = m.axis_index(g.follower);
  c.master_axis = m.axis_index(g.master);
  c.master_spindle = m.spindle_index(g.master);
  c.follower_turns = g.ratio[0];
  c.master_turns = g.ratio[1];
  c.by = g.source == machine::GearSource::measured ? axis::CouplingBy::measured : axis::CouplingBy::setpoint;
  c.window = g.window;
  if (g.in_phase) c.phase = g.phase;
  return c;
}

channel::ProcessConfig process_config(const machine::MachineConfig& m, int index) {
  channel::ProcessConfig c;
  c.index = index;
  c.path.period_s = m.control.cycle_time;
  c.path.reserve = m.control.path_reserve / 100.0;
  c.path.threads.window = m.control.thread_window;
  c.path.threads.hold_retracts = m.control.thread_hold_retracts;
  c.path.threads.by_infeed = m.control.thread_retract_side == machine::ThreadSide::infeed;
  c.path.threads.tap_overshoot = m.control.tap_overshoot;
  c.probe = switch_place(m, m.control.probe);
  if (m.control.probe_latch != machine::ProbeLatch::edge)
    c.probe_latch = m.control.probe_latch == machine::ProbeLatch::drive_1 ? image::LatchSource::probe_1
                                                                          : image::LatchSource::probe_2;
  c.path.axis_count = std::min<int>(static_cast<int>(m.program_axes()), path::kMaxAxes);
  for (int i = 0; i < c.path.axis_count; ++i) {
    const machine::AxisConfig& a = m.axes[static_cast<std::size_t>(i)];
    c.axes.machine.push_back(i);
    c.path.limits[static_cast<std::size_t>(i)] = {a.max_velocity, a.max_acceleration, a.max_jerk};
    c.axes.letters.push_back(a.letter);
    c.path.threads.retract[static_cast<std::size_t>(i)] = a.thread_retract;
    if (!a.endless()) {
      c.path.threads.travel_min[static_cast<std::size_t>(i)] = a.travel_min;
      c.path.threads.travel_max[static_cast<std::size_t>(i)] = a.travel_max;
    }
    c.path.rotary[static_cast<std::size_t>(i)] = a.type == machine::AxisType::rotary;
    if (a.diameter && (c.axes.surface_speed_axis < 0 || a.process == index + 1))
      c.axes.surface_speed_axis = i;
  }
  if (const machine::SpindleConfig* spindle = m.spindle_of_process(index); spindle != nullptr) {
    c.axes.spindle_min_rpm = spindle->min_speed;
    c.axes.spindle_max_rpm = spindle->max_speed;
    c.axes.spindle_rpm_s = spindle->acceleration;
  }
  c.handshake_timeout_s = m.plc.handshake_timeout;
  return c;
}

}  // namespace servogate::gateway
