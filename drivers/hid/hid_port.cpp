// SPDX-License-Identifier: Apache-2.0
#include "drivers/hid/hid_port.hpp"

#include <hidapi/hidapi.h>
#include <pthread.h>
#include <unistd.h>

#include "firmware_if/text/finding.hpp"

namespace servogate::hid {

namespace {

using drivers::PendantNews;

constexpr std::chrono::milliseconds kLookAgain{500}, kGrain{20};

const text::Entry kNoHid{"hid.no-hidapi", "the HID devices of this computer cannot be looked at: {0}",
                         "устройства HID этого компьютера недоступны: {0}"};

/// Names and numbers of USB devices are ASCII in practice; what is not becomes '?'.
std::string narrow(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != 0; ++text)
    out += *text >= 0x20 && *text < 0x7F ? static_cast<char>(*text) : '?';
  return out;
}

struct FreeList {
  void operator()(hid_device_info* list) const noexcept { hid_free_enumeration(list); }
};
using List = std::unique_ptr<hid_device_info, FreeList>;

}  // namespace

struct HidPort::Device {
  struct Close {
    void operator()(hid_device* d) const noexcept { hid_close(d); }
  };
  std::unique_ptr<hid_device, Close> handle;
  std::string where;
};

std::unique_ptr<HidPort> HidPort::open(const HidChoice& choice, drivers::Notice& why) {
  if (hid_init() != 0) {
    why = {&kNoHid, {narrow(hid_error(nullptr))}};
    return nullptr;
  }
  std::unique_ptr<HidPort> port(new HidPort(choice));
  port->thread_ = std::thread([p = port.get()] { p->run(); });
  return port;
}

HidPort::~HidPort() {
  end_ = true;
  thread_.join();
}

void HidPort::show(std::vector<std::vector<std::uint8_t>> reports) {
  const std::scoped_lock lock(mutex_);
  shown_ = std::move(reports);
}

std::unique_ptr<HidPort::Device> HidPort::find() {
  const List all(hid_enumerate(choice_.vendor, choice_.product));
  for (const hid_device_info* d = all.get(); d != nullptr; d = d->next) {
    if (!choice_.path.empty() && choice_.path != d->path) continue;
    if (!choice_.serial.empty() && choice_.serial != narrow(d->serial_number)) continue;
    if (hid_device* handle = hid_open_path(d->path)) {
      refused_.clear();
      auto device = std::make_unique<Device>();
      device->handle.reset(handle);
      device->where = d->path;
      return device;
    }
    const std::string words = std::string(d->path) + ": " + narrow(hid_error(nullptr));
    if (words != refused_) put({PendantNews::Kind::not_allowed, {}, words});
    refused_ = words;
  }
  return nullptr;
}

/// False: it has gone.
bool HidPort::serve(Device& device) {
  PendantNews news;
  auto& bytes = news.report.bytes;
  const int got =
      hid_read_timeout(device.handle.get(), bytes.data(), bytes.size(), static_cast<int>(kGrain.count()));
  if (got < 0) return false;
  if (got > 0) {
    news.report.size = static_cast<std::size_t>(got);
    put(std::move(news));
  }
  std::vector<std::vector<std::uint8_t>> shown;
  {
    const std::scoped_lock lock(mutex_);
    shown.swap(shown_);
  }
  // A display that does not take them is no reason to do without the hand: reading says whether it is there.
  for (const auto& report : shown)
    if (hid_send_feature_report(device.handle.get(), report.data(), report.size()) < 0) break;
  return true;
}

void HidPort::run() {
  pthread_setname_np(pthread_self(), "hid");
  while (!end_) {
    const std::unique_ptr<Device> device = find();
    if (device == nullptr) {
      for (auto waited = kGrain * 0; waited < kLookAgain && !end_; waited += kGrain)
        std::this_thread::sleep_for(kGrain);
      continue;
    }
    put({PendantNews::Kind::plugged, {}, device->where});
    while (!end_ && serve(*device)) {
    }
    if (!end_) put({PendantNews::Kind::unplugged, {}, device->where});
  }
}

std::vector<HidEntry> hid_devices() {
  std::vector<HidEntry> out;
  const List all(hid_enumerate(0, 0));
  for (const hid_device_info* d = all.get(); d != nullptr; d = d->next)
    out.push_back({d->vendor_id, d->product_id, d->path, narrow(d->serial_number), narrow(d->product_string),
                   access(d->path, R_OK | W_OK) == 0});
  return out;
}

}  // namespace servogate::hid
