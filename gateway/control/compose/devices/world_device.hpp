// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/control/compose/devices/device_table.hpp"

namespace servogate::gateway {

/// The row of mock: urls: the simulated line or chip of these stations, which the world owns.
std::unique_ptr<image::CycleDevice> open_world_device(const DeviceRequest& request, drivers::Notice& why);

}  // namespace servogate::gateway
