// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <readerwriterqueue/readerwriterqueue.h>

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "drivers/notice.hpp"
#include "drivers/usb/libusb_port.hpp"
#include "drivers/waker.hpp"
#include "firmware_if/board/master/port.hpp"
#include "firmware_if/board/protocol/bytes.hpp"

namespace servogate::board {

/// Boards, by the class of their interface.
const usb::DeviceKind& board_kind();

/// The pipes of a board behind a thread; two wait-free queues part it from the cycle. A message that finds
/// the board gone, or too many before it, is not kept: what is old when it arrives would be a wrong command.
/// While the board is gone it is looked for twice a second.
class UsbBoard final : public Port, private usb::PortListener {
 public:
  using Opener = std::function<std::unique_ptr<usb::UsbPort>(drivers::Notice& why)>;

  /// `opener` opens the device now, and again after it was pulled. nullptr: it is not there, `why` says what
  /// mends it. Not real-time safe.
  static std::unique_ptr<UsbBoard> open(Opener opener, drivers::Notice& why);
  /// By serial number, or "any". Not real-time safe.
  static std::unique_ptr<UsbBoard> open(const std::string& serial, drivers::Notice& why);
  /// Sends what was written last, and ends the thread. Not real-time safe.
  ~UsbBoard() override;
  UsbBoard(const UsbBoard&) = delete;
  UsbBoard& operator=(const UsbBoard&) = delete;

  /// real-time safe.
  std::size_t read(std::span<std::uint8_t> buffer) noexcept override;
  /// real-time safe but for one system call that never waits.
  bool write(std::span<const std::uint8_t> message) noexcept override;

 private:
  static constexpr std::size_t kOutgoing = 8, kIncoming = 16;
  struct Bytes {
    std::size_t size = 0;
    std::array<std::uint8_t, kMostBytes> data{};
  };

  UsbBoard(Opener opener, std::unique_ptr<usb::UsbPort> port);
  void work() noexcept;
  bool start() noexcept;
  void serve() noexcept;
  void pump() noexcept;
  void give_up() noexcept;
  void look_for_it() noexcept;
  void read(std::span<const std::uint8_t> bytes) noexcept override;
  void written(std::size_t slot, bool good) noexcept override;

  Opener opener_;
  std::unique_ptr<usb::UsbPort> port_;  ///< of the thread
  /// The same for the cycle, which only wakes it; nullptr: the board is gone. `waking_` holds its end back
  /// while the cycle is in it.
  std::atomic<usb::UsbPort*> awake_{nullptr};
  std::atomic<bool> waking_{false};
  drivers::Waker ending_;
  moodycamel::ReaderWriterQueue<Bytes> outgoing_{kOutgoing};
  moodycamel::ReaderWriterQueue<Bytes> incoming_{kIncoming};
  std::array<bool, usb::UsbPort::kSlots> under_way_{};
  std::thread thread_;
};

}  // namespace servogate::board
