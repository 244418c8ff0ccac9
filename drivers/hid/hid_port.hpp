// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "drivers/notice.hpp"
#include "drivers/pendant_port.hpp"

namespace servogate::hid {

/// Which HID device.
struct HidChoice {
  std::uint16_t vendor = 0, product = 0;
  std::string serial;  ///< empty: any
  std::string path;    ///< "/dev/hidraw0", or a link to one; empty: any
};

/// A pendant as hidapi finds it. It need not be there: it is looked for every half second until it comes, and
/// again after it was unplugged, which is told within milliseconds.
class HidPort final : public drivers::PendantPort {
 public:
  /// nullptr: `why` says what is wrong with the computer. Starts a thread. Not real-time safe.
  static std::unique_ptr<HidPort> open(const HidChoice& choice, drivers::Notice& why);
  ~HidPort() override;
  HidPort(const HidPort&) = delete;
  HidPort& operator=(const HidPort&) = delete;

  void show(std::vector<std::vector<std::uint8_t>> reports) override;

 private:
  explicit HidPort(HidChoice choice);
  struct Device;
  class Screen;
  void run();
  std::unique_ptr<Device> find();
  bool serve(Device& device);

  const HidChoice choice_;
  std::set<std::string> refused_;  ///< what was told since one could be opened
  std::mutex mutex_;
  std::unique_ptr<Screen> screen_;  ///< of the pendant that is there
  std::atomic<bool> end_{false};
  std::thread thread_;
};

/// A HID device of this computer, for a list.
struct HidEntry {
  std::uint16_t vendor = 0, product = 0;
  std::string path, serial, name;
  bool allowed = false;  ///< this program may open it
};
/// In the order in which the system has them. Not real-time safe.
std::vector<HidEntry> hid_devices();

}  // namespace servogate::hid
