// SPDX-License-Identifier: Apache-2.0
#include "machine/modbus_blocks.hpp"

#include <cmath>

#include "firmware_if/modbus/coalesce.hpp"

namespace servogate::machine {

ModbusChannels modbus_channels(const ModbusMap& m, ChannelKind kind) {
  using modbus::Function;
  switch (kind) {
    case ChannelKind::di:
      return {m.di_as_registers ? Function::read_input_registers : Function::read_discrete_inputs,
              m.di_address, m.di_count, m.di_as_registers};
    case ChannelKind::dq:
      return {Function::write_multiple_coils, m.dq_address, m.dq_count};
    case ChannelKind::ai:
      return {Function::read_input_registers, m.ai_address, m.ai_count};
    case ChannelKind::aq:
      return {Function::write_multiple_registers, m.aq_address, m.aq_count};
  }
  return {Function::read_discrete_inputs};
}

std::vector<modbus::Block> modbus_blocks(const StationConfig& station, const ModbusMap& layout) {
  std::vector<modbus::Range> wanted;
  for (const ChannelKind kind : kModbusKinds) {
    const ModbusChannels c = modbus_channels(layout, kind);
    wanted.push_back(
        {c.function, static_cast<std::uint16_t>(c.address), static_cast<std::uint32_t>(c.items())});
  }
  return modbus::coalesce(wanted, static_cast<std::uint8_t>(station.unit),
                          static_cast<image::Nanoseconds>(std::llround(station.period * 1e9)));
}

}  // namespace servogate::machine
