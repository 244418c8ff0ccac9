// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/modbus_device.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/modbus/link.hpp"
#include "drivers/modbus/modbus_line.hpp"
#include "gateway/control/compose/setup/modbus_setup.hpp"

namespace servogate::gateway {

namespace {

modbus::Parity parity_of(machine::LineParity parity) {
  switch (parity) {
    case machine::LineParity::none:
      return modbus::Parity::none;
    case machine::LineParity::odd:
      return modbus::Parity::odd;
    case machine::LineParity::even:
      break;
  }
  return modbus::Parity::even;
}

/// Eleven bits a character whatever the parity: Modbus over Serial Line V1.02, 2.5.1.
int stop_bits_of(const machine::LineConfig& line) {
  if (line.stop_bits != 0) return line.stop_bits;
  return line.parity == machine::LineParity::none ? 2 : 1;
}

}  // namespace

std::optional<modbus::LinkSettings> link_settings(const machine::LineConfig& line) {
  constexpr std::string_view kTcp = "tcp:", kRtu = "rtu:";
  const std::string_view url = line.url, rest = url.substr(std::min(url.size(), kTcp.size()));
  modbus::LinkSettings settings;
  settings.answer_timeout_ns = static_cast<image::Nanoseconds>(std::llround(line.timeout * 1e9));
  if (url.starts_with(kTcp) && is_tcp_peer(rest))
    settings.peer = *modbus::parse_tcp(rest);
  else if (url.starts_with(kRtu) && is_serial_device(rest))
    settings.peer = modbus::SerialPort{std::string(rest), static_cast<std::uint32_t>(line.baud),
                                       parity_of(line.parity), stop_bits_of(line)};
  else
    return std::nullopt;
  return settings;
}

bool is_tcp_peer(std::string_view rest) { return modbus::parse_tcp(rest).has_value(); }

bool is_serial_device(std::string_view rest) { return rest.size() > 1 && rest.front() == '/'; }

bool serial_available(const DeviceRequest& request, drivers::Notice& why) {
  return modbus::Link(*link_settings(*request.line)).open(why);
}

std::unique_ptr<image::CycleDevice> open_modbus(const DeviceRequest& request, drivers::Notice& why) {
  const std::vector<LineStation> stations = stations_of_line(request.loaded, request.line->name);
  std::vector<modbus::Unit> units;
  for (const LineStation& s : stations)
    units.push_back({static_cast<std::uint8_t>(s.station->unit), s.source});
  modbus::LineSettings settings;
  settings.link = *link_settings(*request.line);
  return modbus::ModbusLine::open(settings, line_map(stations), units, why);
}

}  // namespace servogate::gateway
