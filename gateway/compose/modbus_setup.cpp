// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/modbus_setup.hpp"

#include <algorithm>
#include <cmath>

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
  modbus::Map map;
  const auto period = static_cast<image::Nanoseconds>(std::llround(station.period * 1e9));
  constexpr machine::ChannelKind kKinds[] = {machine::ChannelKind::di, machine::ChannelKind::dq,
                                             machine::ChannelKind::ai, machine::ChannelKind::aq};
  for (const machine::ChannelKind kind : kKinds) {
    const Channels c = channels(layout, kind);
    const std::size_t first_block = map.blocks.size();
    const int most = modbus::max_count(c.function);
    for (int at = 0; at < c.items(); at += most)
      map.blocks.push_back({static_cast<std::uint8_t>(station.unit), c.function,
                            static_cast<std::uint16_t>(c.address + at),
                            static_cast<std::uint16_t>(std::min(most, c.items() - at)), period});
    for (const machine::PointConfig& p : station.points) {
      if (p.channel != kind || p.number < 0 || p.number >= c.count) continue;
      const int item = c.packed ? p.number / kRegisterBits : p.number;
      modbus::Point point;
      point.block = first_block + static_cast<std::size_t>(item / most);
      point.offset = static_cast<std::uint16_t>(item % most);
      if (c.packed) point.bit = static_cast<std::int8_t>(p.number % kRegisterBits);
      point.place = p.place;
      point.inverted = p.inverted;
      point.on_loss = p.hold ? modbus::OnLoss::hold : modbus::OnLoss::value;
      point.loss_value = p.loss;
      point.scale = p.scale;
      point.shift = p.shift;
      map.points.push_back(point);
    }
  }
  return map;
}

}  // namespace servogate::gateway
