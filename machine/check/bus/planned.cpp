// SPDX-License-Identifier: Apache-2.0
// How the buses of a machine file will be used: nodes, load, and what signals and brakes wait for.
#include <algorithm>
#include <cmath>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/master/sdo_budget.hpp"
#include "machine/can_channel.hpp"
#include "machine/check/bus/slowest.hpp"
#include "machine/consequences.hpp"

namespace servogate::machine {

int slowest(const std::vector<PdoConfig>& pdos, const std::vector<int>& objects) {
  int n = 1;
  for (const PdoConfig& pdo : pdos)
    if (pdo.cyclic() && std::any_of(pdo.objects.begin(), pdo.objects.end(), [&](const PdoObject& o) {
          return std::find(objects.begin(), objects.end(), o.index) != objects.end();
        }))
      n = std::max(n, pdo.transmission);
  return n;
}

const DeviceConfig* device_of(const LoadResult& loaded, const std::string& reference) {
  const NodeConfig* node = loaded.machine.node(reference);
  return node == nullptr ? nullptr : loaded.device(node->device);
}

std::vector<canopen::NodeConfig> planned_nodes(const LoadResult& loaded, const BusConfig& bus) {
  std::vector<canopen::NodeConfig> out;
  for (const NodeConfig& node : bus.nodes) {
    const DeviceConfig* device = loaded.device(node.device);
    if (device == nullptr) continue;
    canopen::NodeConfig planned;
    planned.node = static_cast<canopen::NodeId>(node.id);
    planned.name = node.name;
    planned.profile = drive_profile(*device, node, 0);
    if (device->terminals()) planned.target = canopen::DriveTarget::io;
    planned.heartbeat_ms = static_cast<std::int32_t>(std::lround(node.heartbeat * 1e3));
    out.push_back(std::move(planned));
  }
  return out;
}

canopen::SegmentServices planned_services(const BusConfig& bus) {
  canopen::SegmentServices out;
  for (const NodeConfig& node : bus.nodes)
    if (node.heartbeat > 0.0)
      out.heartbeat_ms =
          std::min(out.heartbeat_ms, static_cast<std::int32_t>(std::lround(node.heartbeat * 1e3)));
  out.sync_counter = bus.sync_counter;
  out.time_ms = static_cast<std::int32_t>(std::lround(bus.time_period * 1e3));
  return out;
}

canopen::SegmentLoad segment_load(const LoadResult& loaded, const BusConfig& bus) {
  return canopen::segment_load(static_cast<std::uint32_t>(bus.bit_rate), loaded.machine.cycle_ns(),
                               planned_nodes(loaded, bus), planned_services(bus));
}

double read_every(const LoadResult& loaded, const StationConfig& s) {
  if (s.kind == StationKind::modbus) return s.period;
  const DeviceConfig* device = s.over_bus() ? device_of(loaded, s.node) : nullptr;
  if (device == nullptr) return 0.0;
  std::vector<int> objects;
  for (const PointConfig& p : s.points) {
    if (!p.is_input()) continue;
    const auto found = channel_object(device->kind, p.channel, p.number);
    objects.push_back(found ? found->object.index : canopen::object::kDigitalInputs);
  }
  return slowest(device->tpdos, objects) * loaded.machine.control.cycle_time;
}

double brake_command_time(const LoadResult& loaded, const AxisConfig& axis) {
  const MachineConfig& m = loaded.machine;
  if (!axis.brake.present()) return 0.0;
  const double cycle = m.control.cycle_time;
  if (axis.brake.drive_output) {
    const DeviceConfig* device = device_of(loaded, axis.drive);
    return (device == nullptr ? 1 : slowest(device->rpdos, {canopen::object::kDigitalOutputs})) * cycle;
  }
  int station = -1;
  const PointConfig* point = m.point(axis.brake.point, &station);
  if (point == nullptr) return cycle;
  const StationConfig& s = m.stations[static_cast<std::size_t>(station)];
  if (s.kind == StationKind::modbus) return s.period + cycle;
  const DeviceConfig* device = s.over_bus() ? device_of(loaded, s.node) : nullptr;
  if (device == nullptr) return cycle;
  const auto found = channel_object(device->kind, point->channel, point->number);
  return slowest(device->rpdos, {found ? found->object.index : canopen::object::kDigitalOutputs}) * cycle;
}

double sdo_round(const LoadResult& loaded, const std::string& reference) {
  int index = -1;
  const NodeConfig* node = loaded.machine.node(reference, &index);
  if (node == nullptr) return 0.0;
  const BusConfig& bus = loaded.machine.buses[static_cast<std::size_t>(index)];
  if (bus.bit_rate <= 0) return 0.0;
  canopen::SegmentConfig segment;
  segment.cycle_ns = loaded.machine.cycle_ns();
  segment.nodes = planned_nodes(loaded, bus);
  const canopen::SegmentServices services = planned_services(bus);
  segment.heartbeat_ms = services.heartbeat_ms;
  segment.time_ms = services.time_ms;
  const bool spindle = std::any_of(loaded.machine.spindles.begin(), loaded.machine.spindles.end(),
                                   [&](const SpindleConfig& s) { return s.drive == reference; });
  for (canopen::NodeConfig& planned : segment.nodes) {
    if (planned.node != node->id) continue;
    if (spindle) planned.target = canopen::DriveTarget::spindle;
    return static_cast<double>(
               canopen::sdo_round_ns(segment, planned, static_cast<std::uint32_t>(bus.bit_rate))) *
           1e-9;
  }
  return 0.0;
}

double own_motion_lag(const LoadResult& loaded, const AxisConfig& axis) {
  const NodeConfig* node = loaded.machine.node(axis.drive);
  const DeviceConfig* device = node == nullptr ? nullptr : loaded.device(node->device);
  if (device == nullptr || device->behaviour.position_mode != PositionMode::pp ||
      axis.max_acceleration <= 0.0)
    return 0.0;
  // The handshake of a set-point by process data: given, answered, withdrawn, answered.
  constexpr double kCyclesOfHandshake = 8.0;
  const double by_sdo = sdo_round(loaded, axis.drive);
  const double between = by_sdo > 0.0 ? by_sdo : kCyclesOfHandshake * loaded.machine.control.cycle_time;
  return axis.max_velocity * axis.max_velocity / (2.0 * axis.max_acceleration) +
         2.0 * axis.max_velocity * between;
}

}  // namespace servogate::machine
