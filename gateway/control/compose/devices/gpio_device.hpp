// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/control/compose/devices/device_table.hpp"

namespace servogate::gateway {

/// The row of chip: urls: a GPIO chip of this computer by its label or name; the number of a point's channel
/// is its line.
/// The chip of the station is there and nobody else has its lines; none of them is taken.
bool gpio_available(const DeviceRequest& request, drivers::Notice& why);
std::unique_ptr<image::CycleDevice> open_gpio_device(const DeviceRequest& request, drivers::Notice& why);

}  // namespace servogate::gateway
