// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "drivers/usb/libusb_port.hpp"

namespace servogate::gsusb {

/// Adapters of the gs_usb class. One that a driver of the kernel has is left to it.
const usb::DeviceKind& adapter_kind();

}  // namespace servogate::gsusb
