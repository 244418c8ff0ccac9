// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <readerwriterqueue/readerwriterqueue.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "drivers/notice.hpp"
#include "drivers/send_queue.hpp"
#include "drivers/slcan/line.hpp"
#include "drivers/slcan/serial_port.hpp"
#include "drivers/waker.hpp"

namespace servogate::slcan {

struct SlcanConfig {
  SerialPlace place;
  std::uint32_t bit_rate = 0;  ///< bit/s, set in the adapter; there is no default
  bool listen_only = false;    ///< hears, acknowledges nothing, sends nothing
  image::Nanoseconds answer_within = 500 * image::kMillisecond;  ///< of each command while it is opened
};

/// An adapter with the lines of line.hpp. A thread of its own serves the port; two wait-free queues part it
/// from the caller. Where the adapter acknowledges what it takes, it is given so few frames at a time that
/// those which wait leave by priority. When the port goes away, frames that wait are thrown away and counted,
/// and the bus is down for good. The protocol does not tell of bus-off: state() knows what the adapter's
/// flags say (warning, error-passive), where it has them.
///
/// send(), receive() and state() do not allocate and make at most one system call that never waits. One
/// sender and one receiver at a time.
class SlcanBus final : public image::CanBus {
 public:
  /// Sets the bit rate and opens the channel. nullptr: refused, `why` says what is wrong. Not real-time safe.
  static std::unique_ptr<SlcanBus> open(const SlcanConfig& config, drivers::Notice& why);
  ~SlcanBus() override;
  SlcanBus(const SlcanBus&) = delete;
  SlcanBus& operator=(const SlcanBus&) = delete;

  /// False for CAN FD frames and in listen-only mode, too. real-time safe.
  bool send(const image::CanFrame& frame) noexcept override;
  /// Time stamps are those of arrival. real-time safe.
  bool receive(image::CanFrame& frame) noexcept override;
  image::CanState state() const noexcept override { return state_.load(std::memory_order_acquire); }
  std::uint32_t bit_rate() const noexcept override { return config_.bit_rate; }
  std::uint64_t lost() const noexcept override { return lost_.load(std::memory_order_relaxed); }

  /// For poll(2): readable when a frame has come or the state has changed.
  int descriptor() const noexcept { return told_.descriptor(); }

 private:
  static constexpr std::size_t kOutgoing = 128, kIncoming = 4096;
  /// Frames in an adapter that acknowledges them.
  static constexpr int kInAdapter = 4;
  /// An acknowledgement that has not come by then was lost.
  static constexpr image::Nanoseconds kPatience = 200 * image::kMillisecond;
  static constexpr image::Nanoseconds kFlagsEvery = 100 * image::kMillisecond;

  SlcanBus(SerialPort port, SlcanConfig config);
  bool start(drivers::Notice& why);
  bool put(std::string_view command);
  std::optional<Answer> hear();
  bool somebody_answers();
  void work() noexcept;
  bool read() noexcept;
  bool write() noexcept;
  void take(const Answer& answer, image::Nanoseconds now) noexcept;
  void set_flags(std::uint8_t flags) noexcept;
  bool may_write() const noexcept { return rest_ > 0 || !queue_.empty() || asks_flags_; }
  bool has_room(image::Nanoseconds now) noexcept;
  void next_command(image::Nanoseconds now) noexcept;
  void acknowledge(bool good) noexcept;
  void go_down() noexcept;
  void deliver(const image::CanFrame& frame) noexcept;

  SerialPort port_;
  SlcanConfig config_;
  moodycamel::ReaderWriterQueue<image::CanFrame> outgoing_{kOutgoing};
  moodycamel::ReaderWriterQueue<image::CanFrame> incoming_{kIncoming};
  std::atomic<image::CanState> state_{image::CanState::error_active};
  std::atomic<std::uint64_t> lost_{0};
  drivers::Waker wake_, told_;
  // Of the thread alone.
  Reader reader_;
  drivers::SendQueue queue_;
  std::array<char, kLongestFrame> command_{};
  std::size_t rest_ = 0, begun_ = 0;  ///< of the command that the port has not taken whole
  int in_adapter_ = 0;
  bool acknowledges_ = false, has_flags_ = false, asks_flags_ = false;
  image::Nanoseconds last_sent_ns_ = 0, flags_due_ns_ = 0;
  std::thread thread_;
};

}  // namespace servogate::slcan
