// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "machine/device.hpp"
#include "machine/keys/reader.hpp"

namespace servogate::machine {

/// What is wrong with the registers of a device of kind inverter.
void check_inverter_device(const DeviceConfig& device, Reading& reading);

}  // namespace servogate::machine
