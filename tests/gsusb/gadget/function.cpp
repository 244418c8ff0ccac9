// SPDX-License-Identifier: Apache-2.0
#include "tests/gsusb/gadget/function.hpp"

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "drivers/clock.hpp"

namespace servogate::gsusb {
namespace {

struct Pipes {
  usb_interface_descriptor interface;
  usb_endpoint_descriptor_no_audio in, out;
} __attribute__((packed));

/// What FunctionFS wants to hear first. Source: linux/usb/functionfs.h, descriptors version 2.
struct Descriptors {
  usb_functionfs_descs_head_v2 head;
  __le32 full_speed_count, high_speed_count;
  Pipes full_speed, high_speed;
} __attribute__((packed));

struct Strings {
  usb_functionfs_strings_head head;
} __attribute__((packed));

Pipes pipes(std::uint16_t packet) {
  Pipes p{};
  p.interface.bLength = sizeof p.interface;
  p.interface.bDescriptorType = USB_DT_INTERFACE;
  p.interface.bNumEndpoints = 2;
  p.interface.bInterfaceClass = p.interface.bInterfaceSubClass = p.interface.bInterfaceProtocol =
      USB_CLASS_VENDOR_SPEC;
  p.in.bLength = p.out.bLength = sizeof p.in;
  p.in.bDescriptorType = p.out.bDescriptorType = USB_DT_ENDPOINT;
  p.in.bmAttributes = p.out.bmAttributes = USB_ENDPOINT_XFER_BULK;
  p.in.wMaxPacketSize = p.out.wMaxPacketSize = htole16(packet);
  p.in.bEndpointAddress = 1 | USB_DIR_IN;
  p.out.bEndpointAddress = 2 | USB_DIR_OUT;
  return p;
}

int open_or_throw(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) throw std::system_error(errno, std::generic_category(), path);
  return file;
}

template <typename T>
void write_whole(int file, const T& what, const char* name) {
  if (write(file, &what, sizeof what) != static_cast<ssize_t>(sizeof what))
    throw std::system_error(errno, std::generic_category(), name);
}

std::uint32_t now_us() {
  return static_cast<std::uint32_t>(drivers::clock_ns(CLOCK_MONOTONIC) / image::kMicrosecond);
}

}  // namespace

GadgetFunction::GadgetFunction(const std::string& folder, SimulatedAdapter& adapter) : adapter_(adapter) {
  requests_ = open_or_throw(folder + "/ep0");
  Descriptors d{};
  d.head.magic = htole32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  d.head.length = htole32(sizeof d);
  d.head.flags = htole32(FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC);
  d.full_speed_count = d.high_speed_count = htole32(3);
  d.full_speed = pipes(64);
  d.high_speed = pipes(512);
  write_whole(requests_, d, "descriptors");
  Strings s{};
  s.head.magic = htole32(FUNCTIONFS_STRINGS_MAGIC);
  s.head.length = htole32(sizeof s);
  write_whole(requests_, s, "strings");
  in_ = open_or_throw(folder + "/ep1");
  out_ = open_or_throw(folder + "/ep2");
}

GadgetFunction::~GadgetFunction() {
  for (const int file : {out_, in_, requests_})
    if (file >= 0) close(file);
}

void GadgetFunction::serve_requests() {
  usb_functionfs_event event{};
  while (!ending_) {
    const ssize_t got = read(requests_, &event, sizeof event);
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
    done = bytes ? write(requests_, bytes->data(), std::min<std::size_t>(bytes->size(), length))
                 : read(requests_, data.data(), 0);
  } else if (!vendor || length > data.size()) {
    done = write(requests_, data.data(), 0);
  } else {
    // The data stage is over when it has been read: what the adapter makes of it is its own affair, as it is
    // for firmware that reads into a buffer first.
    done = read(requests_, data.data(), length);
    const std::lock_guard hold(mutex_);
    if (done == length) adapter_.take_request(setup.bRequest, value, std::span(data.data(), length));
  }
  if (done < 0 && errno != EL2HLT) ending_ = errno == EBADF;
}

void GadgetFunction::serve_out() {
  std::array<std::uint8_t, 512> data{};
  while (!ending_) {
    const ssize_t got = read(out_, data.data(), data.size());
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
    if (bytes && write(in_, bytes->data(), bytes->size()) < 0 && errno != ESHUTDOWN && errno != EINTR) return;
    if (!bytes) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

}  // namespace servogate::gsusb
