// SPDX-License-Identifier: Apache-2.0
#include "tests/usb_gadget/functionfs.hpp"

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace servogate::gadget {
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

Pipes pipes(const usb::InterfaceClass& interface, std::uint16_t packet) {
  Pipes p{};
  p.interface.bLength = sizeof p.interface;
  p.interface.bDescriptorType = USB_DT_INTERFACE;
  p.interface.bNumEndpoints = 2;
  p.interface.bInterfaceClass = interface.code;
  p.interface.bInterfaceSubClass = interface.subclass;
  p.interface.bInterfaceProtocol = interface.protocol;
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

}  // namespace

FunctionFs::FunctionFs(const std::string& folder, const usb::InterfaceClass& interface) {
  requests_ = open_or_throw(folder + "/ep0");
  Descriptors d{};
  d.head.magic = htole32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  d.head.length = htole32(sizeof d);
  d.head.flags = htole32(FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC);
  d.full_speed_count = d.high_speed_count = htole32(3);
  d.full_speed = pipes(interface, 64);
  d.high_speed = pipes(interface, 512);
  write_whole(requests_, d, "descriptors");
  Strings s{};
  s.head.magic = htole32(FUNCTIONFS_STRINGS_MAGIC);
  s.head.length = htole32(sizeof s);
  write_whole(requests_, s, "strings");
  in_ = open_or_throw(folder + "/ep1");
  out_ = open_or_throw(folder + "/ep2");
}

FunctionFs::~FunctionFs() {
  for (const int file : {out_, in_, requests_})
    if (file >= 0) close(file);
}

}  // namespace servogate::gadget
