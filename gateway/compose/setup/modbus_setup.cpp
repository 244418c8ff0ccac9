// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/setup/modbus_setup.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/modbus/coalesce.hpp"
#include "gateway/compose/points/point_rules.hpp"

namespace servogate::gateway {

namespace {

constexpr int kRegisterBits = 16;

/// How the channels of one kind lie in a station.
struct Channels {
  modbus::Function function;
  int address = 0;
  int count = 0;
  bool packed = false;  ///< sixteen of them in a register
  int items() const { return packed ? (count + kRegisterBits - 1) / kRegisterBits : count; }
};

Channels channels(const machine::ModbusMap& m, machine::ChannelKind kind) {
  using modbus::Function;
  switch (kind) {
    case machine::ChannelKind::di:
      return {m.di_as_registers ? Function::read_input_registers : Function::read_discrete_inputs,
              m.di_address, m.di_count, m.di_as_registers};
    case machine::ChannelKind::dq:
      return {Function::write_multiple_coils, m.dq_address, m.dq_count};
    case machine::ChannelKind::ai:
      return {Function::read_input_registers, m.ai_address, m.ai_count};
    case machine::ChannelKind::aq:
      return {Function::write_multiple_registers, m.aq_address, m.aq_count};
  }
  return {Function::read_discrete_inputs};
}

}  // namespace

modbus::Map modbus_map(const machine::StationConfig& station, const machine::ModbusMap& layout) {
  constexpr machine::ChannelKind kKinds[] = {machine::ChannelKind::di, machine::ChannelKind::dq,
                                             machine::ChannelKind::ai, machine::ChannelKind::aq};
  std::vector<modbus::Range> wanted;
  for (const machine::ChannelKind kind : kKinds) {
    const Channels c = channels(layout, kind);
    wanted.push_back(
        {c.function, static_cast<std::uint16_t>(c.address), static_cast<std::uint32_t>(c.items())});
  }
  modbus::Map map;
  map.blocks = modbus::coalesce(wanted, static_cast<std::uint8_t>(station.unit),
                                static_cast<image::Nanoseconds>(std::llround(station.period * 1e9)));
  for (const machine::ChannelKind kind : kKinds) {
    const Channels c = channels(layout, kind);
    for (const machine::PointConfig& p : station.points) {
      if (p.channel != kind || p.number < 0 || p.number >= c.count) continue;
      const int item = c.packed ? p.number / kRegisterBits : p.number;
      const auto spot = modbus::spot_of(map.blocks, c.function, static_cast<std::uint32_t>(c.address + item));
      if (!spot) continue;
      modbus::Point point;
      point.block = spot->block;
      point.offset = spot->offset;
      if (c.packed) point.bit = static_cast<std::int8_t>(p.number % kRegisterBits);
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
