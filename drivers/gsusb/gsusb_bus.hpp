// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <readerwriterqueue/readerwriterqueue.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "drivers/gsusb/adapter_clock.hpp"
#include "drivers/gsusb/protocol.hpp"
#include "drivers/notice.hpp"
#include "drivers/send_queue.hpp"
#include "drivers/usb/usb_port.hpp"

namespace servogate::gsusb {

using usb::PortListener;
using usb::UsbPort;

/// GsUsbBus::open() refused because the adapter's clock does not have the bit rate.
bool is_no_timing(const drivers::Notice& why) noexcept;

struct GsUsbConfig {
  std::string adapter;         ///< its name in messages
  std::uint32_t bit_rate = 0;  ///< bit/s, set in the adapter; there is no default
  std::uint8_t channel = 0;
  bool listen_only = false;  ///< hears, acknowledges nothing, sends nothing
};

/// A USB-CAN adapter of the gs_usb class without the kernel's driver. A thread of its own serves the USB
/// pipes; two wait-free queues part it from the caller. What it cannot send yet waits in priority order. When
/// the controller goes bus-off or the adapter is unplugged, frames that wait are thrown away and counted, so
/// that nothing stale moves a drive later; after bus-off it takes part again by itself 100 ms later, after
/// unplugging never (CanState::down). Error frames are received like others and tell the state.
///
/// send(), receive() and state() do not allocate and make at most one system call that never waits. One
/// sender and one receiver at a time.
class GsUsbBus final : public image::CanBus, private PortListener {
 public:
  static constexpr image::Nanoseconds kRestartAfter = 100 * image::kMillisecond;

  /// Sets the bit rate and starts the channel. nullptr: refused, `why` says what is wrong.
  static std::unique_ptr<GsUsbBus> open(std::unique_ptr<UsbPort> port, const GsUsbConfig& config,
                                        drivers::Notice& why);
  ~GsUsbBus() override;
  GsUsbBus(const GsUsbBus&) = delete;
  GsUsbBus& operator=(const GsUsbBus&) = delete;

  /// False for CAN FD frames and in listen-only mode, too. real-time safe.
  bool send(const image::CanFrame& frame) noexcept override;
  /// Time stamps are the adapter's where it has a clock, else those of arrival. real-time safe.
  bool receive(image::CanFrame& frame) noexcept override;
  image::CanState state() const noexcept override { return state_.load(std::memory_order_acquire); }
  std::uint32_t bit_rate() const noexcept override { return config_.bit_rate; }
  std::uint64_t lost() const noexcept override { return lost_.load(std::memory_order_relaxed); }

  /// For poll(2): readable when a frame has come or the state has changed.
  int descriptor() const noexcept { return event_; }
  const DeviceConfig& device() const noexcept { return device_; }
  const BitTiming& timing() const noexcept { return timing_; }
  std::uint32_t features() const noexcept { return limits_.feature; }
  /// State and error counters as the adapter has them now. nullopt: it cannot tell. Not real-time safe.
  std::optional<ControllerState> ask_state();

 private:
  static constexpr std::size_t kOutgoing = 128, kIncoming = 4096;
  /// A frame under way: its buffer comes back from the pipe, its tag from the adapter when it has gone.
  struct Slot {
    bool in_pipe = false, in_adapter = false;
  };

  GsUsbBus(std::unique_ptr<UsbPort> port, GsUsbConfig config, int event);
  bool start(drivers::Notice& why);
  bool start_channel();
  void work() noexcept;
  void pump() noexcept;
  void restart_when_due() noexcept;
  void abandon(image::CanState state) noexcept;
  void read(std::span<const std::uint8_t> bytes) noexcept override;
  void written(std::size_t slot, bool good) noexcept override;
  void deliver(const image::CanFrame& frame) noexcept;
  void tell() noexcept;
  bool stamped() const noexcept { return (limits_.feature & feature::kHardwareTimestamp) != 0; }

  std::unique_ptr<UsbPort> port_;
  GsUsbConfig config_;
  int event_;
  DeviceConfig device_;
  Limits limits_;
  BitTiming timing_;
  moodycamel::ReaderWriterQueue<image::CanFrame> outgoing_{kOutgoing};
  moodycamel::ReaderWriterQueue<image::CanFrame> incoming_{kIncoming};
  std::atomic<image::CanState> state_{image::CanState::error_active};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<bool> ending_{false};
  std::atomic<bool> asking_{false};
  std::optional<ControllerState> answer_;  ///< handed over by asking_
  // Of the thread alone.
  drivers::SendQueue queue_;
  std::array<Slot, UsbPort::kSlots> slots_{};
  AdapterClock clock_;
  image::Nanoseconds restart_at_ = 0;
  std::thread thread_;
};

}  // namespace servogate::gsusb
