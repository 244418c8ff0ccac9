// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/machine/device.hpp"
#include "gateway/machine/keys/reader.hpp"

namespace servogate::machine {

/// Reports an entry of [objects], of a device or of a node, that is no object, does not fit, is a command of
/// the cycle, or that the boot-up writes itself for this device, so that the value would be lost. Not
/// real-time safe.
void check_boot_object(const std::string& name, double value, const DeviceConfig* device, const Where& where,
                       Reading& reading);

}  // namespace servogate::machine
