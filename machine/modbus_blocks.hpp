// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/modbus/map.hpp"
#include "machine/config.hpp"
#include "machine/device.hpp"

namespace servogate::machine {

inline constexpr int kRegisterBits = 16;
inline constexpr ChannelKind kModbusKinds[] = {ChannelKind::di, ChannelKind::dq, ChannelKind::ai,
                                               ChannelKind::aq};

/// How the channels of one kind lie in a Modbus station.
struct ModbusChannels {
  modbus::Function function;
  int address = 0;
  int count = 0;
  bool packed = false;  ///< sixteen of them in a register
  int items() const { return packed ? (count + kRegisterBits - 1) / kRegisterBits : count; }
};
ModbusChannels modbus_channels(const ModbusMap& layout, ChannelKind kind);

/// What is exchanged with a station again and again: all channels of its device, each kind in as few
/// transactions as the protocol permits. Not real-time safe.
std::vector<modbus::Block> modbus_blocks(const StationConfig& station, const ModbusMap& layout);

/// The registers of an inverter's device file.
modbus::InverterRegisters inverter_registers(const InverterMap& layout);
/// What is exchanged with an inverter again and again; places in `inverter` count these blocks. The spindle
/// is not filled in.
struct InverterBlocks {
  std::vector<modbus::Block> blocks;
  modbus::Inverter inverter;
};
InverterBlocks inverter_blocks(const StationConfig& station, const InverterMap& layout);
/// How often it is looked whether the registers are right that nothing turns without.
inline constexpr image::Nanoseconds kRequiredPeriod = image::kSecond;

}  // namespace servogate::machine
