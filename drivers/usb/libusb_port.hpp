// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "drivers/notice.hpp"
#include "drivers/usb/usb_port.hpp"

namespace servogate::usb {

struct Product {
  std::uint16_t vendor = 0, product = 0;
};
/// Class, subclass and protocol of an interface.
struct InterfaceClass {
  std::uint8_t code = 0, subclass = 0, protocol = 0;
  bool operator==(const InterfaceClass&) const = default;
};

/// Devices of one kind: which they are, and how people call them.
struct DeviceKind {
  std::string_view name;    ///< in both languages (text::both): "gs_usb adapter"
  std::string_view scheme;  ///< of the url, "gsusb"
  std::span<const Product> products{};
  /// Of the interface that is used, whatever the product number; code 0: interface 0 of `products`.
  InterfaceClass interface {};
  /// What to do when a driver of the kernel has one; {0} is its serial number. nullptr: as with any other
  /// program.
  const text::Entry* kernel_has_it = nullptr;
};

/// Opens the device of this serial number, or with "any" the only one. nullptr: there is none, there are
/// several, the process may not use it, or another driver has it; `why` says what mends it. Not real-time
/// safe.
std::unique_ptr<UsbPort> open_libusb(const DeviceKind& kind, const std::string& serial, drivers::Notice& why);

}  // namespace servogate::usb
