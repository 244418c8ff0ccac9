// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/board/master/board_device.hpp"
#include "gateway/control/compose/devices/device_table.hpp"

namespace servogate::gateway {

/// A board as the machine file wants it: its points, and the axes whose amplifiers are on its channels.
board::BoardConfig board_config(const machine::MachineConfig& machine, std::size_t station);

/// The row of mock: urls of boards: the one that the world owns.
std::unique_ptr<image::CycleDevice> open_mock_board(const DeviceRequest& request, drivers::Notice& why);
/// The row of usb: urls: a board by its serial number, or the only one.
std::unique_ptr<image::CycleDevice> open_usb_board(const DeviceRequest& request, drivers::Notice& why);
/// The board is there and nobody else has it; it is opened and closed.
bool usb_board_available(const DeviceRequest& request, drivers::Notice& why);

}  // namespace servogate::gateway
