// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <string>

#include "machine/device.hpp"
#include "machine/keys/reader.hpp"

namespace servogate::machine {

/// Reports entries of [objects], of a device or of a node, that are no object, do not fit, stand there twice,
/// are commands, or that the boot-up writes itself for this device, so that the value would be lost. `device`
/// may be nullptr. Not real-time safe.
void check_boot_objects(const std::map<std::string, double>& objects, const DeviceConfig* device,
                        const std::function<Where(const std::string& name)>& where, Reading& reading);

}  // namespace servogate::machine
