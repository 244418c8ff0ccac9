// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "drivers/gsusb/usb_port.hpp"
#include "drivers/notice.hpp"

namespace servogate::gsusb {

/// Serial numbers of the adapters that are plugged in; "?" for one whose serial number may not be read. Not
/// real-time safe.
std::vector<std::string> adapters();

/// Opens the adapter of this serial number, or with "any" the only one. nullptr: there is none, there are
/// several, the process may not use it, or the kernel's driver has it; `why` says what mends it. Not
/// real-time safe.
std::unique_ptr<UsbPort> open_libusb(const std::string& serial, drivers::Notice& why);

}  // namespace servogate::gsusb
