// SPDX-License-Identifier: Apache-2.0
#include "tests/gsusb/gadget/function.hpp"

#include <endian.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <thread>

#include "drivers/clock.hpp"

namespace servogate::gsusb {
namespace {

std::uint32_t now_us() {
  return static_cast<std::uint32_t>(drivers::clock_ns(CLOCK_MONOTONIC) / image::kMicrosecond);
}

}  // namespace

GadgetFunction::GadgetFunction(const std::string& folder, SimulatedAdapter& adapter)
    : adapter_(adapter), function_(folder, {USB_CLASS_VENDOR_SPEC, USB_CLASS_VENDOR_SPEC, USB_CLASS_VENDOR_SPEC}) {}

void GadgetFunction::serve_requests() {
  usb_functionfs_event event{};
  while (!ending_) {
    const ssize_t got = read(function_.requests(), &event, sizeof event);
    // EIDRM: the host has given a request up that was not answered in time, and asks anew.
    if (got < 0 && (errno == EIDRM || errno == EINTR)) continue;
    if (got != static_cast<ssize_t>(sizeof event)) return;
    if (event.type == FUNCTIONFS_SETUP) answer(event.u.setup);
    if (event.type == FUNCTIONFS_UNBIND) return;
  }
}

/// A request is stalled by going the other way than it asks for.
void GadgetFunction::answer(const usb_ctrlrequest& setup) {
  const std::uint16_t value = le16toh(setup.wValue), length = le16toh(setup.wLength);
  const bool vendor = (setup.bRequestType & USB_TYPE_MASK) == USB_TYPE_VENDOR;
  std::array<std::uint8_t, 256> data{};
  ssize_t done = 0;
  if ((setup.bRequestType & USB_DIR_IN) != 0) {
    std::optional<SimulatedAdapter::Bytes> bytes;
    if (vendor) {
      const std::lock_guard hold(mutex_);
      bytes = adapter_.answer_request(setup.bRequest, value, now_us());
    }
    done = bytes ? write(function_.requests(), bytes->data(), std::min<std::size_t>(bytes->size(), length))
                 : read(function_.requests(), data.data(), 0);
  } else if (!vendor || length > data.size()) {
    done = write(function_.requests(), data.data(), 0);
  } else {
    // The data stage is over when it has been read: what the adapter makes of it is its own affair, as it is
    // for firmware that reads into a buffer first.
    done = read(function_.requests(), data.data(), length);
    const std::lock_guard hold(mutex_);
    if (done == length) adapter_.take_request(setup.bRequest, value, std::span(data.data(), length));
  }
  if (done < 0 && errno != EL2HLT) ending_ = errno == EBADF;
}

void GadgetFunction::serve_out() {
  std::array<std::uint8_t, 512> data{};
  while (!ending_) {
    const ssize_t got = read(function_.out(), data.data(), data.size());
    if (got < 0 && errno != ESHUTDOWN && errno != EINTR) return;
    if (got < 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (got <= 0) continue;
    const std::lock_guard hold(mutex_);
    adapter_.take_bulk(std::span(data.data(), static_cast<std::size_t>(got)));
    adapter_.step(now_us());
  }
}

void GadgetFunction::serve_in() {
  while (!ending_) {
    std::optional<SimulatedAdapter::Bytes> bytes;
    {
      const std::lock_guard hold(mutex_);
      adapter_.step(now_us());
      bytes = adapter_.give_bulk();
    }
    // Waits until the host takes it; a host that has gone takes nothing.
    if (bytes && write(function_.in(), bytes->data(), bytes->size()) < 0 && errno != ESHUTDOWN && errno != EINTR) return;
    if (!bytes) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

}  // namespace servogate::gsusb
