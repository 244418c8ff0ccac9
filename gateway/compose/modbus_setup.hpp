// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/modbus/map.hpp"
#include "gateway/machine/load.hpp"

/// The machine file's Modbus stations in the terms of a poll plan. Not real-time safe.
namespace servogate::gateway {

/// All channels of a station's device at their addresses, each kind in as few transactions as the protocol
/// permits, with the points of the machine file. Points whose channel the device has not are left out (the
/// check refuses them).
modbus::Map modbus_map(const machine::StationConfig& station, const machine::ModbusMap& layout);

}  // namespace servogate::gateway
