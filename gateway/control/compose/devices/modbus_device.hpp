// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "drivers/modbus/link.hpp"
#include "gateway/control/compose/devices/device_table.hpp"

/// The rows of tcp: and rtu: lines. Not real-time safe.
namespace servogate::gateway {

/// The link of a tcp: or rtu: line; nullopt: its url is neither.
std::optional<modbus::LinkSettings> link_settings(const machine::LineConfig& line);

bool is_tcp_peer(std::string_view rest);
bool is_serial_device(std::string_view rest);
/// The serial device of the line is there, may be opened and is nobody else's; it is closed again.
bool serial_available(const DeviceRequest& request, drivers::Notice& why);
std::unique_ptr<image::CycleDevice> open_modbus(const DeviceRequest& request, drivers::Notice& why);

}  // namespace servogate::gateway
