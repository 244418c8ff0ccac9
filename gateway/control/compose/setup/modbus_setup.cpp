// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/setup/modbus_setup.hpp"

#include "firmware_if/modbus/coalesce.hpp"
#include "gateway/control/compose/points/point_rules.hpp"
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
    out.push_back(
        {&stations[s], device != nullptr ? device->modbus : machine::ModbusMap{}, static_cast<int>(s)});
  }
  return out;
}

modbus::Map line_map(const std::vector<LineStation>& stations) {
  modbus::Map whole;
  for (const LineStation& s : stations) {
    modbus::Map one = modbus_map(*s.station, s.layout);
    for (modbus::Point& p : one.points) {
      p.block += whole.blocks.size();
      whole.points.push_back(p);
    }
    whole.blocks.insert(whole.blocks.end(), one.blocks.begin(), one.blocks.end());
  }
  return whole;
}

}  // namespace servogate::gateway
