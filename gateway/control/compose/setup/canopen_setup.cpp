// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/setup/canopen_setup.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "firmware_if/canopen/402/objects.hpp"
#include "gateway/control/compose/points/point_rules.hpp"
#include "gateway/control/compose/setup/axis_setup.hpp"
#include "machine/can_channel.hpp"

namespace servogate::gateway {

namespace {

std::uint32_t object_value(double value) {
  return static_cast<std::uint32_t>(std::llround(std::clamp(value, 1.0, 4294967295.0)));
}

/// Speeds and acceleration of the axis in the drive's own units. nullopt: whoever homes, the drive is not
/// asked.
std::optional<canopen::NodeHoming> homing_of(const machine::AxisConfig& a, const canopen::DriveProfile& p) {
  const bool has_mode = (p.modes & canopen::supported_bit(canopen::OperationMode::homing)) != 0;
  if (a.home.method != machine::HomingMethod::drive)
    return has_mode ? std::optional(canopen::NodeHoming{}) : std::nullopt;
  const double counts = a.counts_per_unit();
  canopen::NodeHoming h;
  h.method = static_cast<std::int8_t>(a.home.drive_method);
  if (a.home.fast > 0.0) h.speed_switch = object_value(a.home.fast * counts / p.velocity_unit_counts_s);
  if (a.home.slow > 0.0) h.speed_zero = object_value(a.home.slow * counts / p.velocity_unit_counts_s);
  h.acceleration = object_value(a.homing_acceleration() * counts / p.acceleration_unit_counts_s2);
  return h;
}

/// Limits and ramp of a spindle in the units of its drive's 6042h. A ramp of few units a second is told over
/// a longer time.
canopen::NodeVl vl_of(const machine::SpindleConfig& s, const canopen::DriveProfile& p) {
  canopen::NodeVl vl;
  const auto factor = [&p](std::uint16_t index, std::int32_t(&to)[2]) {
    const machine::VlFactor f = machine::vl_factor(p, index);
    to[0] = f.numerator;
    to[1] = f.denominator;
  };
  factor(canopen::object::kVlSetpointFactor, vl.set_point_factor);
  factor(canopen::object::kVlDimensionFactor, vl.dimension_factor);
  const double per_rpm = static_cast<double>(s.first_gear()[0]) / static_cast<double>(s.first_gear()[1]) /
                         60.0 * static_cast<double>(p.counts_per_rev) / std::abs(p.vl_unit_counts_s);
  vl.least = s.min_speed > 0.0 ? object_value(s.min_speed * per_rpm) : 0;
  vl.most = object_value(std::ceil(s.max_speed * per_rpm));
  double speed = s.acceleration * per_rpm;
  while (speed < 100.0 && vl.ramp.seconds < 1000) {
    speed *= 10.0;
    vl.ramp.seconds = static_cast<std::uint16_t>(vl.ramp.seconds * 10);
  }
  vl.ramp.speed = object_value(speed);
  return vl;
}

/// The speed limit is the drive's own and lies above what the control watches.
canopen::NodeTorque torque_of(const machine::AxisConfig& a, const canopen::DriveProfile& p) {
  constexpr double kAbove = 1.3;
  canopen::NodeTorque t;
  if (p.torque_mode == canopen::OperationMode::profile_torque)
    t.slope = object_value(a.greatest_torque_ramp() * 10.0 / p.torque_unit_permille);
  t.max_speed = object_value(std::ceil(kAbove * a.motor_rpm(a.max_velocity)));
  return t;
}

void put_files(const machine::LoadResult& loaded, const machine::NodeConfig& node,
               const std::string& reference, canopen::NodeSetup& setup) {
  const auto found = loaded.node_files.find(reference);
  if (found == loaded.node_files.end()) return;
  const machine::LoadResult::NodeFiles& files = found->second;
  if (node.program_version >= 0) {
    canopen::NodeProgram& program = setup.program.emplace();
    if (node.program_when == machine::ProgramWhen::other_version) program.image = files.program;
    program.identification = static_cast<std::uint32_t>(node.program_version);
    program.number = static_cast<std::uint8_t>(node.program_number);
  }
  setup.program_timeout_ms = static_cast<std::int32_t>(std::lround(node.program_timeout * 1e3));
  setup.concise_dcf = files.concise_dcf;
  setup.configuration_date = files.configuration_date;
  setup.store_configuration = node.configuration_store;
}

std::optional<std::uint32_t> given(std::int64_t value) {
  if (value == 0) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

/// The points of a station of kind canopen, as objects of its node.
canopen::IoStation io_station(const machine::StationConfig& station, const machine::DeviceConfig& device) {
  canopen::IoStation out;
  for (const machine::PointConfig& p : station.points) {
    const auto channel = machine::channel_object(device.kind, p.channel, p.number);
    if (!channel) continue;
    canopen::IoPoint point;
    point.rule = point_rule(p);
    point.index = channel->object.index;
    point.subindex = channel->object.subindex;
    point.bit = channel->bit;
    out.points.push_back(point);
  }
  return out;
}

/// The node carries a station. False: it carries none.
bool take_station(const machine::LoadResult& loaded, const machine::NodeConfig& node,
                  const std::string& reference, canopen::NodeConfig& n) {
  const machine::MachineConfig& m = loaded.machine;
  const machine::DeviceConfig* device = loaded.device(node.device);
  for (std::size_t s = 0; s < m.stations.size(); ++s) {
    if (m.stations[s].kind != machine::StationKind::canopen || m.stations[s].node != reference) continue;
    if (device == nullptr || !device->terminals()) return false;
    n.target = canopen::DriveTarget::io;
    n.target_index = static_cast<int>(s);
    n.io = io_station(m.stations[s], *device);
    n.io.error_states = device->behaviour.connection_loss != machine::ConnectionLoss::none;
    n.setup.counts_per_rev = given(device->encoder.counts_per_rev);
    n.setup.revolutions = given(device->encoder.revolutions);
    return true;
  }
  return false;
}

}  // namespace

canopen::SegmentConfig segment_config(const machine::LoadResult& loaded, int index) {
  const machine::MachineConfig& m = loaded.machine;
  const machine::BusConfig& bus = m.buses[static_cast<std::size_t>(index)];
  canopen::SegmentConfig c;
  c.index = index;
  c.name = bus.name;
  c.cycle_ns = m.cycle_ns();
  if (bus.sync_counter) c.sync_counter_overflow = 240;
  c.sync_window_us = static_cast<std::int32_t>(std::lround(bus.sync_window * 1e6));
  c.time_ms = static_cast<std::int32_t>(std::lround(bus.time_period * 1e3));
  for (const machine::NodeConfig& node : bus.nodes) {
    canopen::NodeConfig n;
    n.node = static_cast<canopen::NodeId>(node.id);
    n.name = node.name;
    const std::string reference = bus.name + "." + node.name;
    std::int64_t counts = 0;
    double ramp_rpm_s = 0.0;  // of a spindle's motor
    double braking_counts_s2 = 0.0;
    bool used = false;
    for (std::size_t a = 0; a < m.axes.size(); ++a)
      if (m.axes[a].drive == reference) {
        n.target = canopen::DriveTarget::axis;
        n.target_index = static_cast<int>(a);
        counts = m.axes[a].counts_per_rev;
        braking_counts_s2 = m.axes[a].max_acceleration * m.axes[a].counts_per_unit();
        used = true;
      }
    for (std::size_t s = 0; s < m.spindles.size(); ++s)
      if (m.spindles[s].drive == reference) {
        n.target = canopen::DriveTarget::spindle;
        n.target_index = static_cast<int>(s);
        counts = counts_per_motor_turn(m.spindles[s]);
        ramp_rpm_s = m.spindles[s].acceleration * static_cast<double>(m.spindles[s].first_gear()[0]) /
                     static_cast<double>(m.spindles[s].first_gear()[1]);
        used = true;
      }
    if (!used && !take_station(loaded, node, reference, n)) continue;
    if (const machine::DeviceConfig* device = loaded.device(node.device); device != nullptr)
      n.profile = machine::drive_profile(*device, node, counts);
    if (n.target == canopen::DriveTarget::spindle &&
        n.profile.velocity_mode == canopen::OperationMode::profile_velocity)
      n.setup.speed_ramp = object_value(ramp_rpm_s / 60.0 * static_cast<double>(n.profile.counts_per_rev) /
                                        n.profile.acceleration_unit_counts_s2);
    if (n.target == canopen::DriveTarget::spindle &&
        n.profile.velocity_mode == canopen::OperationMode::velocity)
      n.setup.vl = vl_of(m.spindles[static_cast<std::size_t>(n.target_index)], n.profile);
    if (n.target == canopen::DriveTarget::spindle &&
        !m.spindles[static_cast<std::size_t>(n.target_index)].axis.empty())
      n.profile.modes |= canopen::supported_bit(n.profile.position_mode);
    if (n.target == canopen::DriveTarget::spindle)
      braking_counts_s2 = ramp_rpm_s / 60.0 * static_cast<double>(n.profile.counts_per_rev);
    n.setup.quick_stop_ramp = object_value(braking_counts_s2 / n.profile.acceleration_unit_counts_s2);
    if (n.target == canopen::DriveTarget::axis) {
      const machine::AxisConfig& axis = m.axes[static_cast<std::size_t>(n.target_index)];
      n.setup.homing = homing_of(axis, n.profile);
      // What it forms by itself keeps to the limits of the axis.
      if (n.profile.position_mode == canopen::OperationMode::profile_position) {
        n.setup.profile_speed =
            object_value(axis.max_velocity * axis.counts_per_unit() / n.profile.velocity_unit_counts_s);
        n.setup.speed_ramp = object_value(braking_counts_s2 / n.profile.acceleration_unit_counts_s2);
      }
      if (axis.torque_max > 0.0) {
        n.setup.torque = torque_of(axis, n.profile);
        n.profile.modes |= canopen::supported_bit(n.profile.torque_mode);
      }
      if (axis.home.method == machine::HomingMethod::drive)
        n.profile.modes |= canopen::supported_bit(canopen::OperationMode::homing);
    }
    n.heartbeat_ms = static_cast<std::int32_t>(std::lround(node.heartbeat * 1e3));
    n.max_missed_pdo = static_cast<std::int32_t>(node.loss_cycles);
    n.unsupervised = node.unsupervised;
    n.setup.software_version = node.software_version;
    n.loss_reaction = loss_reaction(node.loss_reaction);
    put_files(loaded, node, reference, n.setup);
    n.setup.boot_timeout_ms = static_cast<std::int32_t>(std::lround(node.boot_timeout * 1e3));
    n.setup.boot_attempts = node.boot_attempts;
    n.setup.sdo_timeout_ms = static_cast<std::int32_t>(std::lround(node.sdo_timeout * 1e3));
    n.setup.sdo_retries = node.sdo_retries;
    // The control's own heartbeat is as quick as the quickest node's.
    if (n.heartbeat_ms > 0) c.heartbeat_ms = std::min(c.heartbeat_ms, n.heartbeat_ms);
    c.nodes.push_back(std::move(n));
  }
  c.heartbeat_timeout_ms = 3 * c.heartbeat_ms;
  return c;
}

}  // namespace servogate::gateway
