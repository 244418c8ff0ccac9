// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/modbus/map.hpp"
#include "machine/load.hpp"

/// The machine file's Modbus stations in the terms of a poll plan. Not real-time safe.
namespace servogate::gateway {

/// All channels of a station's device at their addresses, each kind in as few transactions as the protocol
/// permits, with the points of the machine file. Points whose channel the device has not are left out (the
/// check refuses them).
modbus::Map modbus_map(const machine::StationConfig& station, const machine::ModbusMap& layout);

/// A station of a line and its place among the sources.
struct LineStation {
  const machine::StationConfig* station = nullptr;
  machine::ModbusMap layout;
  int source = 0;
  const machine::DeviceConfig* inverter = nullptr;  ///< its device file where it is one
  const machine::SpindleConfig* spindle = nullptr;  ///< that it turns
  int spindle_index = 0;
};
/// The stations of a line by its name, in the order of the machine file.
std::vector<LineStation> stations_of_line(const machine::LoadResult& loaded, const std::string& line);
/// The maps of all of them as that of the line.
modbus::Map line_map(const std::vector<LineStation>& stations);

}  // namespace servogate::gateway
