// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "firmware_if/image/time.hpp"

namespace servogate::usb {

/// Hears what happened on the pipes of a port, inside of UsbPort::serve().
class PortListener {
 public:
  virtual ~PortListener() = default;
  virtual void read(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// The buffer `slot` is free again. `good`: the device has taken it.
  virtual void written(std::size_t slot, bool good) noexcept = 0;
};

/// A device that is plugged in, as bytes: libusb's, or a simulated one. All but wake() belong to one thread.
class UsbPort {
 public:
  /// Messages that are under way to the device at once: it has few buffers, and what it has taken it treats
  /// in the order of taking.
  static constexpr std::size_t kSlots = 10;

  virtual ~UsbPort() = default;
  /// Vendor requests to the interface, repeated while the device only is silent, for some seconds at most.
  /// False: it refused, stayed silent, or is gone. control_in fills the beginning of `data` and says how
  /// much.
  virtual bool control_out(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data) = 0;
  virtual std::size_t control_in(std::uint8_t request, std::uint16_t value, std::span<std::uint8_t> data) = 0;
  /// Why the last of these requests failed, in the words of USB ("LIBUSB_ERROR_TIMEOUT").
  virtual std::string failure() const = 0;
  /// Keeps transfers of at most `bytes` waiting on the in pipe from now on.
  virtual bool start(std::size_t bytes, PortListener& listener) = 0;
  /// Puts bytes on the out pipe from buffer `slot`, which written() gives back. False: they could not be put.
  virtual bool write(std::size_t slot, std::span<const std::uint8_t> bytes) noexcept = 0;
  /// Waits until something happens, wake() is called or the time is over; tells the listener. False: the
  /// device is gone.
  virtual bool serve(image::Nanoseconds at_most) noexcept = 0;
  /// From any thread. real-time safe (one system call that never waits).
  virtual void wake() noexcept = 0;
};

}  // namespace servogate::usb
