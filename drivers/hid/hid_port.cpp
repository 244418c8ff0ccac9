// SPDX-License-Identifier: Apache-2.0
#include "drivers/hid/hid_port.hpp"

#include <hidapi/hidapi.h>
#include <pthread.h>
#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <utility>

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

/// hidapi keeps one error text for all threads: whoever lists or opens devices does so alone.
std::mutex& hidapi() {
  static std::mutex mutex;
  return mutex;
}

struct Close {
  void operator()(hid_device* d) const noexcept { hid_close(d); }
};
using Handle = std::unique_ptr<hid_device, Close>;

/// What a link of udev leads to; the name itself where it leads nowhere yet.
std::string device_of(const std::string& path) {
  std::error_code error;
  const auto real = std::filesystem::canonical(path, error);
  return error ? path : real.string();
}

}  // namespace

struct HidPort::Device {
  Handle handle;
  std::string where;
};

/// Writes its display, which may take seconds, so that the hand is read meanwhile.
class HidPort::Screen {
 public:
  explicit Screen(Handle handle) : handle_(std::move(handle)) {
    if (handle_ != nullptr) thread_ = std::thread([this] { run(); });
  }
  ~Screen() {
    {
      const std::scoped_lock lock(mutex_);
      end_ = true;
    }
    came_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  void show(std::vector<std::vector<std::uint8_t>> reports) {
    const std::scoped_lock lock(mutex_);
    reports_ = std::move(reports);
    came_.notify_all();
  }

 private:
  void run() {
    pthread_setname_np(pthread_self(), "hid-display");
    std::unique_lock lock(mutex_);
    for (;;) {
      came_.wait(lock, [this] { return end_ || !reports_.empty(); });
      if (end_) return;
      const auto reports = std::exchange(reports_, {});
      lock.unlock();
      // A display that does not take them is no reason to do without the hand.
      for (const auto& report : reports)
        if (hid_send_feature_report(handle_.get(), report.data(), report.size()) < 0) break;
      lock.lock();
    }
  }

  Handle handle_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<std::vector<std::uint8_t>> reports_;
  bool end_ = false;
  std::thread thread_;
};

std::unique_ptr<HidPort> HidPort::open(const HidChoice& choice, drivers::Notice& why) {
  const std::scoped_lock lock(hidapi());
  if (hid_init() != 0) {
    why = {&kNoHid, {narrow(hid_error(nullptr))}};
    return nullptr;
  }
  std::unique_ptr<HidPort> port(new HidPort(choice));
  port->thread_ = std::thread([p = port.get()] { p->run(); });
  return port;
}

HidPort::HidPort(HidChoice choice) : choice_(std::move(choice)) {}

HidPort::~HidPort() {
  end_ = true;
  thread_.join();
}

void HidPort::show(std::vector<std::vector<std::uint8_t>> reports) {
  const std::scoped_lock lock(mutex_);
  if (screen_ != nullptr) screen_->show(std::move(reports));
}

std::unique_ptr<HidPort::Device> HidPort::find() {
  const std::scoped_lock lock(hidapi());
  const List all(hid_enumerate(choice_.vendor, choice_.product));
  const std::string path = choice_.path.empty() ? std::string() : device_of(choice_.path);
  for (const hid_device_info* d = all.get(); d != nullptr; d = d->next) {
    if (!path.empty() && path != d->path) continue;
    if (!choice_.serial.empty() && choice_.serial != narrow(d->serial_number)) continue;
    if (hid_device* handle = hid_open_path(d->path)) {
      refused_.clear();
      auto device = std::make_unique<Device>();
      device->handle.reset(handle);
      device->where = d->path;
      auto screen = std::make_unique<Screen>(Handle(hid_open_path(d->path)));
      const std::scoped_lock shown(mutex_);
      screen_ = std::move(screen);
      return device;
    }
    const std::string words = std::string(d->path) + ": " + narrow(hid_error(nullptr));
    if (refused_.insert(words).second) put({PendantNews::Kind::not_allowed, {}, words});
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
    std::unique_ptr<Screen> gone;
    {
      const std::scoped_lock lock(mutex_);
      gone = std::move(screen_);
    }
  }
}

std::vector<HidEntry> hid_devices() {
  std::vector<HidEntry> out;
  const std::scoped_lock lock(hidapi());
  const List all(hid_enumerate(0, 0));
  for (const hid_device_info* d = all.get(); d != nullptr; d = d->next)
    out.push_back({d->vendor_id, d->product_id, d->path, narrow(d->serial_number), narrow(d->product_string),
                   access(d->path, R_OK | W_OK) == 0});
  return out;
}

}  // namespace servogate::hid
