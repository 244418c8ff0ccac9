// SPDX-License-Identifier: Apache-2.0
#include "drivers/gsusb/adapters.hpp"

namespace servogate::gsusb {
namespace {

const text::Entry kKernelHasIt{
    "gsusb.kernel-has-it",
    "the kernel's own driver has the adapter {0}: use its interface, socketcan:can0 (`ip link` names it), or "
    "take the driver away: sudo modprobe -r gs_usb",
    "адаптером {0} управляет драйвер ядра: используйте его интерфейс, socketcan:can0 (имя покажет `ip "
    "link`), "
    "либо выгрузите драйвер: sudo modprobe -r gs_usb"};
const std::string kName = text::both("gs_usb adapter", "адаптер gs_usb");

/// Those that speak the protocol on interface 0.
constexpr usb::Product kProducts[] = {
    {0x1D50, 0x606F}, {0x1209, 0x2323}, {0x1CD2, 0x606F}, {0x16D0, 0x10B8}, {0x16D0, 0x0F30},
};

}  // namespace

const usb::DeviceKind& adapter_kind() {
  static const usb::DeviceKind kind{kName, "gsusb", kProducts, {}, &kKernelHasIt};
  return kind;
}

}  // namespace servogate::gsusb
