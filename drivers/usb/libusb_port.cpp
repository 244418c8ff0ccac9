// SPDX-License-Identifier: Apache-2.0
#include "drivers/usb/libusb_port.hpp"

#include <libusb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#include "drivers/clock.hpp"

namespace servogate::usb {
namespace {

const text::Entry kNoUsb{"usb.no-usb", "this computer has no USB that can be used: {0}",
                         "на этом компьютере нет доступного USB: {0}"};
const text::Entry kNoDevice{"usb.no-device", "there is no {0} '{1}'; plugged in: {2}",
                            "{0} «{1}» не найдено; подключены: {2}"};
const text::Entry kSeveral{"usb.several", "several devices of the kind {0} are plugged in: {1}; say which: {2}:SERIAL",
                           "подключено несколько устройств вида «{0}»: {1}; укажите одно: {2}:СЕРИЙНЫЙ"};
const text::Entry kNoRight{
    "usb.no-right",
    "the {0} {1} may not be used by this user; a file /etc/udev/rules.d/70-servogate-usb.rules with the line "
    "SUBSYSTEM==\"usb\", ATTRS{idVendor}==\"{2}\", ATTRS{idProduct}==\"{3}\", MODE=\"0660\", "
    "TAG+=\"uaccess\" lets it, after the device is plugged in again",
    "{0} {1}: нет доступа у этого пользователя; файл /etc/udev/rules.d/70-servogate-usb.rules со строкой "
    "SUBSYSTEM==\"usb\", ATTRS{idVendor}==\"{2}\", ATTRS{idProduct}==\"{3}\", MODE=\"0660\", "
    "TAG+=\"uaccess\" даст доступ после нового подключения"};
const text::Entry kBusy{"usb.busy", "another program has the {0} {1}", "{0} {1}: занято другой программой"};
const text::Entry kOpen{"usb.open", "the {0} {1} cannot be opened: {2}", "{0} {1} не открывается: {2}"};

/// A request that got no answer is repeated as long as USB 2.0, 9.2.6.1 gives a device: a busy computer, or a
/// hub that recovers, is no dead device.
constexpr unsigned kAnswer_ms = 1500;
constexpr image::Nanoseconds kPatience = 5 * image::kSecond;
constexpr auto kRecovery = std::chrono::milliseconds(200);
constexpr std::size_t kReads = 30;
/// A multiple of every packet size of bulk pipes up to high speed, so that no transfer overflows.
constexpr std::size_t kReadBytes = 512;
/// Failed transfers after one another that a disturbed cable may make.
constexpr int kBearable = 16;

struct CloseContext {
  void operator()(libusb_context* c) const noexcept { libusb_exit(c); }
};
struct CloseHandle {
  void operator()(libusb_device_handle* h) const noexcept { libusb_close(h); }
};
struct FreeTransfer {
  void operator()(libusb_transfer* t) const noexcept { libusb_free_transfer(t); }
};
using Context = std::unique_ptr<libusb_context, CloseContext>;
using Handle = std::unique_ptr<libusb_device_handle, CloseHandle>;
using Transfer = std::unique_ptr<libusb_transfer, FreeTransfer>;

Context open_context(int& error) {
  libusb_context* context = nullptr;
  error = libusb_init(&context);
  return Context(error == 0 ? context : nullptr);
}

/// The interface of a device and its in and out bulk pipes; number -1: it has none that fits.
struct Pipes {
  int number = -1;
  std::uint8_t in = 0, out = 0;
};

/// A device that is plugged in; `handle` is empty where it may not be opened.
struct Found {
  std::string serial = "?";
  libusb_device_descriptor descriptor{};
  Handle handle;
  int error = 0;
};

Pipes pipes_of(const libusb_interface_descriptor& i) {
  Pipes pipes;
  for (int e = 0; e < i.bNumEndpoints; ++e) {
    if ((i.endpoint[e].bmAttributes & 3) != LIBUSB_TRANSFER_TYPE_BULK) continue;
    const std::uint8_t address = i.endpoint[e].bEndpointAddress;
    std::uint8_t& pipe = (address & LIBUSB_ENDPOINT_IN) != 0 ? pipes.in : pipes.out;
    if (pipe == 0) pipe = address;
  }
  if (pipes.in != 0 && pipes.out != 0) pipes.number = i.bInterfaceNumber;
  return pipes;
}

Pipes find_pipes(libusb_device* device, const DeviceKind& kind) {
  libusb_config_descriptor* config = nullptr;
  Pipes pipes;
  if (libusb_get_active_config_descriptor(device, &config) != 0) return pipes;
  for (int n = 0; n < config->bNumInterfaces && pipes.number < 0; ++n) {
    if (config->interface[n].num_altsetting < 1) continue;
    const libusb_interface_descriptor& i = config->interface[n].altsetting[0];
    const InterfaceClass here{i.bInterfaceClass, i.bInterfaceSubClass, i.bInterfaceProtocol};
    if (kind.interface.code == 0 ? n == 0 : here == kind.interface) pipes = pipes_of(i);
  }
  libusb_free_config_descriptor(config);
  return pipes;
}

bool fits(libusb_device* device, const libusb_device_descriptor& d, const DeviceKind& kind) {
  if (kind.interface.code != 0) return find_pipes(device, kind).number >= 0;
  return std::any_of(kind.products.begin(), kind.products.end(),
                     [&](const Product& p) { return p.vendor == d.idVendor && p.product == d.idProduct; });
}

std::vector<Found> find(libusb_context* context, const DeviceKind& kind) {
  std::vector<Found> all;
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  for (ssize_t i = 0; i < count; ++i) {
    Found f;
    if (libusb_get_device_descriptor(list[i], &f.descriptor) != 0 || !fits(list[i], f.descriptor, kind)) continue;
    libusb_device_handle* handle = nullptr;
    f.error = libusb_open(list[i], &handle);
    if (f.error == 0) {
      f.handle.reset(handle);
      std::array<unsigned char, 128> text{};
      const int length = libusb_get_string_descriptor_ascii(handle, f.descriptor.iSerialNumber, text.data(),
                                                            static_cast<int>(text.size()));
      if (length > 0)
        f.serial.assign(reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(length));
    }
    all.push_back(std::move(f));
  }
  if (count >= 0) libusb_free_device_list(list, 1);
  return all;
}

std::string names(const std::vector<Found>& all) {
  std::string list;
  for (const Found& f : all) list += (list.empty() ? "" : ", ") + f.serial;
  return list.empty() ? text::both("none", "ни одного") : list;
}

std::string hex(std::uint16_t word) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%04x", word);
  return text.data();
}

class LibusbPort final : public UsbPort {
 public:
  LibusbPort(Context context, Handle handle, const Pipes& pipes, int wake)
      : context_(std::move(context)), handle_(std::move(handle)), pipes_(pipes), wake_(wake) {}
  ~LibusbPort() override;

  bool control_out(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data) override {
    // libusb takes one pointer for both directions; it reads only from this one.
    return control(kVendorOut, request, value, {const_cast<unsigned char*>(data.data()), data.size()}) ==
           data.size();
  }
  std::size_t control_in(std::uint8_t request, std::uint16_t value, std::span<std::uint8_t> data) override {
    return control(kVendorIn, request, value, data);
  }
  std::string failure() const override {
    return failure_ < 0 ? libusb_error_name(failure_)
                        : text::both("its answer is too short", "ответ слишком короткий");
  }
  bool start(std::size_t bytes, PortListener& listener) override;
  bool write(std::size_t slot, std::span<const std::uint8_t> bytes) noexcept override;
  bool serve(image::Nanoseconds at_most) noexcept override;
  void wake() noexcept override {
    const std::uint64_t one = 1;
    if (::write(wake_, &one, sizeof one) < 0) return;  // the counter is full: it is awake
  }

 private:
  static constexpr std::uint8_t kVendorOut =
      std::uint8_t{LIBUSB_REQUEST_TYPE_VENDOR} | std::uint8_t{LIBUSB_RECIPIENT_INTERFACE};
  static constexpr std::uint8_t kVendorIn = kVendorOut | std::uint8_t{LIBUSB_ENDPOINT_IN};
  struct Buffer {
    LibusbPort* port = nullptr;
    std::size_t index = 0;
    Transfer transfer;
    std::array<std::uint8_t, kReadBytes> bytes{};
  };

  /// How many bytes went over; 0 with failure_ set where none did.
  std::size_t control(std::uint8_t direction, std::uint8_t request, std::uint16_t value,
                      std::span<std::uint8_t> data);
  static void has_read(libusb_transfer* transfer) noexcept;
  static void has_written(libusb_transfer* transfer) noexcept;
  bool submit(Buffer& buffer) noexcept;
  bool set_up(Buffer& buffer, std::size_t index);
  /// Whether the pipe still works after this transfer.
  bool bearable(const libusb_transfer& transfer) noexcept;

  Context context_;
  Handle handle_;
  Pipes pipes_;
  int wake_;
  PortListener* listener_ = nullptr;
  std::array<Buffer, kReads> reads_;
  std::array<Buffer, kSlots> writes_;
  std::vector<pollfd> polled_;
  int under_way_ = 0, failures_ = 0, failure_ = 0;
  bool gone_ = false, ending_ = false;
};

LibusbPort::~LibusbPort() {
  ending_ = true;
  for (Buffer& b : reads_)
    if (b.transfer) libusb_cancel_transfer(b.transfer.get());
  for (Buffer& b : writes_)
    if (b.transfer) libusb_cancel_transfer(b.transfer.get());
  const image::Nanoseconds until = drivers::clock_ns(CLOCK_MONOTONIC) + image::kSecond;
  while (under_way_ > 0 && drivers::clock_ns(CLOCK_MONOTONIC) < until) {
    timeval slice{0, 10'000};
    libusb_handle_events_timeout_completed(context_.get(), &slice, nullptr);
  }
  libusb_release_interface(handle_.get(), pipes_.number);
  if (under_way_ > 0) {
    // The kernel still owns their memory: better kept than freed under it.
    for (Buffer& b : reads_) (void)b.transfer.release();
    for (Buffer& b : writes_) (void)b.transfer.release();
  }
  close(wake_);
}

std::size_t LibusbPort::control(std::uint8_t direction, std::uint8_t request, std::uint16_t value,
                                std::span<std::uint8_t> data) {
  const image::Nanoseconds until = drivers::clock_ns(CLOCK_MONOTONIC) + kPatience;
  int got = 0;
  for (;; std::this_thread::sleep_for(kRecovery)) {
    got = libusb_control_transfer(handle_.get(), direction, request, value, static_cast<std::uint16_t>(pipes_.number), data.data(),
                                  static_cast<std::uint16_t>(data.size()), kAnswer_ms);
    const bool silent = got == LIBUSB_ERROR_TIMEOUT || got == LIBUSB_ERROR_IO;
    if (!silent || drivers::clock_ns(CLOCK_MONOTONIC) > until) break;
  }
  failure_ = std::min(got, 0);
  return static_cast<std::size_t>(std::max(got, 0));
}

bool LibusbPort::set_up(Buffer& buffer, std::size_t index) {
  buffer.port = this;
  buffer.index = index;
  buffer.transfer.reset(libusb_alloc_transfer(0));
  return buffer.transfer != nullptr;
}

bool LibusbPort::start(std::size_t bytes, PortListener& listener) {
  if (bytes > kReadBytes) return false;
  listener_ = &listener;
  for (std::size_t i = 0; i < kSlots; ++i) {
    Buffer& b = writes_[i];
    if (!set_up(b, i)) return false;
    libusb_fill_bulk_transfer(b.transfer.get(), handle_.get(), pipes_.out, b.bytes.data(), 0, &has_written, &b, 0);
  }
  for (std::size_t i = 0; i < kReads; ++i) {
    Buffer& b = reads_[i];
    if (!set_up(b, i)) return false;
    libusb_fill_bulk_transfer(b.transfer.get(), handle_.get(), pipes_.in, b.bytes.data(),
                              static_cast<int>(kReadBytes), &has_read, &b, 0);
    if (!submit(b)) return false;
  }
  const libusb_pollfd** list = libusb_get_pollfds(context_.get());
  if (list == nullptr) return false;
  polled_.push_back({wake_, POLLIN, 0});
  for (const libusb_pollfd** p = list; *p != nullptr; ++p) polled_.push_back({(*p)->fd, (*p)->events, 0});
  libusb_free_pollfds(list);
  return true;
}

bool LibusbPort::submit(Buffer& buffer) noexcept {
  failure_ = libusb_submit_transfer(buffer.transfer.get());
  if (failure_ != 0) return false;
  ++under_way_;
  return true;
}

bool LibusbPort::bearable(const libusb_transfer& transfer) noexcept {
  if (transfer.status == LIBUSB_TRANSFER_COMPLETED) {
    failures_ = 0;
    return true;
  }
  return transfer.status != LIBUSB_TRANSFER_NO_DEVICE && transfer.status != LIBUSB_TRANSFER_STALL &&
         transfer.status != LIBUSB_TRANSFER_CANCELLED && ++failures_ < kBearable;
}

void LibusbPort::has_read(libusb_transfer* transfer) noexcept {
  Buffer& b = *static_cast<Buffer*>(transfer->user_data);
  LibusbPort& port = *b.port;
  --port.under_way_;
  if (port.ending_ || port.gone_) return;
  const bool bearable = port.bearable(*transfer);
  if (bearable && transfer->status == LIBUSB_TRANSFER_COMPLETED)
    port.listener_->read({b.bytes.data(), static_cast<std::size_t>(transfer->actual_length)});
  if (!bearable || !port.submit(b)) port.gone_ = true;
}

void LibusbPort::has_written(libusb_transfer* transfer) noexcept {
  Buffer& b = *static_cast<Buffer*>(transfer->user_data);
  LibusbPort& port = *b.port;
  --port.under_way_;
  if (port.ending_) return;
  if (!port.bearable(*transfer)) port.gone_ = true;
  port.listener_->written(b.index, transfer->status == LIBUSB_TRANSFER_COMPLETED);
}

bool LibusbPort::write(std::size_t slot, std::span<const std::uint8_t> bytes) noexcept {
  Buffer& b = writes_[slot];
  if (gone_ || bytes.size() > b.bytes.size()) return false;
  std::copy(bytes.begin(), bytes.end(), b.bytes.begin());
  b.transfer->length = static_cast<int>(bytes.size());
  return submit(b);
}

bool LibusbPort::serve(image::Nanoseconds at_most) noexcept {
  const timespec limit{at_most / image::kSecond, at_most % image::kSecond};
  if (!gone_) ppoll(polled_.data(), polled_.size(), &limit, nullptr);
  std::uint64_t told;
  if (::read(wake_, &told, sizeof told) < 0 && errno != EAGAIN) return false;
  timeval now{0, 0};
  const int error = libusb_handle_events_timeout_completed(context_.get(), &now, nullptr);
  return !gone_ && (error == 0 || error == LIBUSB_ERROR_INTERRUPTED);
}

}  // namespace

std::unique_ptr<UsbPort> open_libusb(const DeviceKind& kind, const std::string& serial, drivers::Notice& why) {
  const std::string name(kind.name);
  int error = 0;
  Context context = open_context(error);
  if (!context) {
    why = {&kNoUsb, {libusb_error_name(error)}};
    return nullptr;
  }
  std::vector<Found> all = find(context.get(), kind);
  const bool any = serial == "any";
  auto at = std::find_if(all.begin(), all.end(), [&](const Found& f) { return any || f.serial == serial; });
  // One that may not be opened hides its number: it may be the one.
  if (at == all.end()) at = std::find_if(all.begin(), all.end(), [](const Found& f) { return !f.handle; });
  if (at == all.end()) {
    why = {&kNoDevice, {name, serial, names(all)}};
    return nullptr;
  }
  if (any && all.size() > 1) {
    why = {&kSeveral, {name, names(all), std::string(kind.scheme)}};
    return nullptr;
  }
  if (!at->handle) {
    why = at->error == LIBUSB_ERROR_ACCESS
              ? drivers::Notice{&kNoRight, {name, serial, hex(at->descriptor.idVendor), hex(at->descriptor.idProduct)}}
              : drivers::Notice{&kOpen, {name, serial, libusb_error_name(at->error)}};
    return nullptr;
  }
  const Pipes pipes = find_pipes(libusb_get_device(at->handle.get()), kind);
  if (kind.kernel_has_it != nullptr && pipes.number >= 0 &&
      libusb_kernel_driver_active(at->handle.get(), pipes.number) == 1) {
    why = {kind.kernel_has_it, {at->serial}};
    return nullptr;
  }
  Handle handle = std::move(at->handle);
  const std::string number = at->serial;
  all.clear();
  error = pipes.number >= 0 ? libusb_claim_interface(handle.get(), pipes.number) : LIBUSB_ERROR_NOT_FOUND;
  const int wake = error == 0 ? eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC) : -1;
  if (wake >= 0) return std::make_unique<LibusbPort>(std::move(context), std::move(handle), pipes, wake);
  why = error == LIBUSB_ERROR_BUSY ? drivers::Notice{&kBusy, {name, number}}
                                   : drivers::Notice{&kOpen, {name, number, libusb_error_name(error)}};
  return nullptr;
}

}  // namespace servogate::usb
