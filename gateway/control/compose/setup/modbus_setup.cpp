// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/setup/modbus_setup.hpp"

#include "firmware_if/modbus/coalesce.hpp"
#include "gateway/control/compose/points/point_rules.hpp"
#include "gateway/control/compose/setup/axis_setup.hpp"
#include "machine/modbus_blocks.hpp"

namespace servogate::gateway {

modbus::Map modbus_map(const machine::StationConfig& station, const machine::ModbusMap& layout) {
  modbus::Map map;
  map.blocks = machine::modbus_blocks(station, layout);
  for (const machine::ChannelKind kind : machine::kModbusKinds) {
    const machine::ModbusChannels c = machine::modbus_channels(layout, kind);
    for (const machine::PointConfig& p : station.points) {
      if (p.channel != kind || p.number < 0 || p.number >= c.count) continue;
      const int item = c.packed ? p.number / machine::kRegisterBits : p.number;
      const auto spot = modbus::spot_of(map.blocks, c.function, static_cast<std::uint32_t>(c.address + item));
      if (!spot) continue;
      modbus::Point point;
      point.block = spot->block;
      point.offset = spot->offset;
      if (c.packed) point.bit = static_cast<std::int8_t>(p.number % machine::kRegisterBits);
      point.rule = point_rule(p);
      map.points.push_back(point);
    }
  }
  return map;
}

std::vector<LineStation> stations_of_line(const machine::LoadResult& loaded, const std::string& line) {
  std::vector<LineStation> out;
  const std::vector<machine::StationConfig>& stations = loaded.machine.stations;
  for (std::size_t s = 0; s < stations.size(); ++s) {
    if (stations[s].kind != machine::StationKind::modbus || stations[s].line != line) continue;
    const machine::DeviceConfig* device = loaded.device(stations[s].device);
    LineStation one{&stations[s], device != nullptr ? device->modbus : machine::ModbusMap{},
                    static_cast<int>(s)};
    const std::vector<machine::SpindleConfig>& spindles = loaded.machine.spindles;
    for (std::size_t n = 0; n < spindles.size(); ++n)
      if (device != nullptr && device->kind == machine::DeviceKind::inverter &&
          spindles[n].inverter == stations[s].name) {
        one.inverter = device;
        one.spindle = &spindles[n];
        one.spindle_index = static_cast<int>(n);
      }
    out.push_back(one);
  }
  return out;
}

namespace {

/// The registers of an inverter behind what the line has.
void add_inverter(const LineStation& s, modbus::Map& map) {
  machine::InverterBlocks own = machine::inverter_blocks(*s.station, s.inverter->inverter);
  const std::size_t first = map.blocks.size();
  modbus::Inverter& i = own.inverter;
  const auto moved = [first](std::optional<modbus::Spot>& spot) {
    if (spot) spot->block += first;
  };
  i.command += first;
  i.frequency += first;
  if (i.reset) *i.reset += first;
  moved(i.status);
  moved(i.output);
  moved(i.fault);
  for (modbus::Spot& spot : i.required) spot.block += first;
  i.spindle = s.spindle_index;
  const double rpm_per_hz = 1.0 / s.spindle->hertz(1.0);
  i.counts_s_per_hz = rpm_per_hz / 60.0 * static_cast<double>(kInverterCounts);
  map.blocks.insert(map.blocks.end(), own.blocks.begin(), own.blocks.end());
  map.inverters.push_back(std::move(i));
}

}  // namespace

modbus::Map line_map(const std::vector<LineStation>& stations) {
  modbus::Map whole;
  for (const LineStation& s : stations) {
    modbus::Map one = modbus_map(*s.station, s.layout);
    for (modbus::Point& p : one.points) {
      p.block += whole.blocks.size();
      whole.points.push_back(p);
    }
    whole.blocks.insert(whole.blocks.end(), one.blocks.begin(), one.blocks.end());
    if (s.inverter != nullptr) add_inverter(s, whole);
  }
  return whole;
}

}  // namespace servogate::gateway
