// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>

#include "drivers/gsusb/gsusb_bus.hpp"
#include "tests/gsusb/simulated_adapter.hpp"

namespace servogate::gsusb {

/// Two ends of a CAN wire between threads. Thread-safe.
class Wire {
 public:
  class End final : public image::CanBus {
   public:
    End(Wire& wire, int number) : wire_(wire), number_(number) {}
    bool send(const image::CanFrame& frame) noexcept override {
      const std::lock_guard hold(wire_.mutex_);
      if (!wire_.acknowledged_) return false;
      wire_.to_[1 - number_].push_back(frame);
      return true;
    }
    bool receive(image::CanFrame& frame) noexcept override {
      const std::lock_guard hold(wire_.mutex_);
      auto& mine = wire_.to_[number_];
      if (mine.empty()) return false;
      frame = mine.front();
      mine.pop_front();
      return true;
    }
    image::CanState state() const noexcept override { return image::CanState::error_active; }
    std::uint32_t bit_rate() const noexcept override { return 500'000; }

   private:
    Wire& wire_;
    int number_;
  };

  image::CanBus& end(int number) { return ends_[static_cast<std::size_t>(number)]; }
  /// Without it no frame is ever sent: nobody else is on the bus.
  void acknowledge(bool yes) {
    const std::lock_guard hold(mutex_);
    acknowledged_ = yes;
  }

 private:
  std::mutex mutex_;
  bool acknowledged_ = true;
  std::deque<image::CanFrame> to_[2];
  End ends_[2] = {{*this, 0}, {*this, 1}};
};

/// The simulated adapter on its wire, plugged in until unplug(). Shared by the test and the port of the bus.
struct Plugged {
  explicit Plugged(SimulatedAdapter::Config config = {}) : adapter(wire.end(0), config) {}

  Wire wire;
  std::mutex mutex;
  std::condition_variable news;
  SimulatedAdapter adapter;  ///< under mutex
  std::atomic<bool> present{true};
  bool woken = false;

  template <typename Act>
  auto with(Act act) {
    const std::lock_guard hold(mutex);
    return act(adapter);
  }
  void unplug() {
    present = false;
    news.notify_all();
  }
};

/// USB between the two: no bytes are lost, transfers are whole.
class PluggedPort final : public UsbPort {
 public:
  explicit PluggedPort(std::shared_ptr<Plugged> plugged) : plugged_(std::move(plugged)) {}
  bool control_out(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data) override;
  std::size_t control_in(std::uint8_t request, std::uint16_t value, std::span<std::uint8_t> data) override;
  std::string failure() const override { return plugged_->present ? "refused" : "unplugged"; }
  bool start(std::size_t bytes, PortListener& listener) override;
  bool write(std::size_t slot, std::span<const std::uint8_t> bytes) noexcept override;
  bool serve(image::Nanoseconds at_most) noexcept override;
  void wake() noexcept override;

 private:
  std::shared_ptr<Plugged> plugged_;
  PortListener* listener_ = nullptr;
  std::size_t largest_ = 0;
  std::deque<std::size_t> taken_;
};

}  // namespace servogate::gsusb
