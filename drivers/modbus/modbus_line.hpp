// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/latest.hpp"
#include "drivers/modbus/link.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/modbus/exchange.hpp"

namespace servogate::modbus {

struct LineSettings {
  LinkSettings link;
  PollSettings poll;
  /// Age from which the data of a block count as stale, in periods of the block; as lost (bad) after twice
  /// that.
  int stale_after_periods = 3;
};

/// A real Modbus line: one thread asks its units in turn, carrying the poller; the cycle takes what came and
/// leaves what is to be written, never waiting. Units are asked while cycles come: before the first one, and
/// when none has come for kSilentCycle, nothing is sent, so that the watchdogs of the units see a dead
/// control. At its end outputs are written once more, with their values of loss.
class ModbusLine final : public image::CycleDevice, public CountedLine {
 public:
  static constexpr image::Nanoseconds kSilentCycle = image::kSecond;
  /// Between attempts to open a link that does not hold; doubled each time.
  static constexpr image::Nanoseconds kFirstPause = 100 * image::kMillisecond,
                                      kLastPause = 5 * image::kSecond;

  /// Opens a serial device, and starts the thread. nullptr: refused, `why` says what is wrong and what mends
  /// it. A TCP peer is sought later, again and again. Not real-time safe.
  static std::unique_ptr<ModbusLine> open(const LineSettings& settings, const Map& map,
                                          const std::vector<Unit>& units, drivers::Notice& why);
  ~ModbusLine() override;
  ModbusLine(const ModbusLine&) = delete;
  ModbusLine& operator=(const ModbusLine&) = delete;

  /// What has come since the last cycle into the image. real-time safe.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// Takes the outputs; what has changed wakes the thread by one system call that never waits. real-time
  /// safe.
  void send(image::ProcessImage& image) noexcept override;

  const Map& map() const noexcept { return exchange_.map(); }
  LineCounters counters() const noexcept override { return tally_.counters(); }

 private:
  /// What is known of a block, from the thread to the cycle.
  struct Arrived {
    Outcome outcome;           ///< the last good one; its time by CLOCK_MONOTONIC
    std::uint32_t faults = 0;  ///< transactions of it that failed so far
  };
  struct Box {
    drivers::Latest<Data> to_write;
    drivers::Latest<Arrived> arrived;
    Arrived known;                   ///< the thread's
    std::optional<Data> wanted;      ///< the thread's: the newest that is to be written
    std::uint32_t faults_taken = 0;  ///< the cycle's
    image::Nanoseconds taken_ns = 0;
  };
  /// The cycle's end of what is to be written.
  class Letters final : public WriteSink {
   public:
    explicit Letters(ModbusLine& line) : line_(line) {}
    void write(std::size_t block, const Data& data, image::Nanoseconds t) noexcept override;

   private:
    ModbusLine& line_;
  };

  ModbusLine(const LineSettings& settings, const Map& map, const std::vector<Unit>& units);
  void work() noexcept;
  bool cycles_come(image::Nanoseconds now) noexcept;
  void open_link(image::Nanoseconds now);
  void transact(const Poller::Next& next);
  void drop_link(bool broken) noexcept;
  void pause() noexcept;
  void take_letters(image::Nanoseconds now) noexcept;
  void take_leave();
  bool write_now(std::size_t block, const Data& data);
  void wait_until(image::Nanoseconds t) noexcept;

  Exchange exchange_;  ///< the cycle's
  std::vector<Box> boxes_;
  Letters letters_{*this};
  std::atomic<image::Nanoseconds> last_cycle_ns_{-1};
  drivers::Waker waker_;
  LineTally tally_;
  // Of the thread alone, once it runs.
  Link link_;
  Poller poller_;
  image::Nanoseconds silence_ns_;
  bool polling_ = false;
  bool linked_ = false;  ///< the link is open, or there is no reason why it could not be opened
  image::Nanoseconds idle_since_ns_ = 0, open_at_ns_ = 0, pause_ns_ = 0;
  std::thread thread_;
};

}  // namespace servogate::modbus
