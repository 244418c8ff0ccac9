// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/mock/modbus/station.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "firmware_if/image/simulated.hpp"
#include "firmware_if/modbus/exchange.hpp"
#include "firmware_if/modbus/line_counters.hpp"

namespace servogate::mock {

/// The line between master and stations, and the master's patience.
struct LineSettings {
  std::uint32_t baud = 115200;  ///< RTU: 11 bit a character, 3.5 characters of silence; 0: no line time (TCP)
  image::Nanoseconds latency_ns = 0;  ///< added to each transaction (TCP round trip)
  image::Nanoseconds answer_timeout_ns = 100 * image::kMillisecond;
  modbus::PollSettings poll;
  /// Age from which the data of a block count as stale, in periods of the block; as lost (bad) after twice
  /// that.
  int stale_after_periods = 3;
};

/// A Modbus line in simulated time: one transaction at a time, real PDUs between the poller and its stations.
/// As Simulated it lets time pass on the line; as CycleDevice it moves finished blocks into packet A and
/// takes outputs from it, never waiting.
class MockModbusLine final : public image::CycleDevice, public image::Simulated, public modbus::CountedLine {
 public:
  /// `sources`: of each station in image.sources; empty: 0, 1, 2 ...
  MockModbusLine(LineSettings line, const modbus::Map& map, std::vector<StationSettings> stations,
                 const std::vector<int>& sources = {});

  /// Data finished since the last cycle into the image. real-time safe.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// Takes the outputs from the image; they go out with the block's next transaction. real-time safe.
  void send(image::ProcessImage& image) noexcept override;
  void advance_to(image::Nanoseconds t) override;

  modbus::LineCounters counters() const noexcept override { return tally_.counters(); }

  std::size_t stations() const noexcept { return stations_.size(); }
  ModbusStation& station(std::size_t n) { return stations_[n]; }
  const modbus::Map& map() const noexcept { return exchange_.map(); }
  /// Time that one fault-free transaction of a block takes on this line.
  image::Nanoseconds transaction_ns(const modbus::Block& block,
                                    image::Nanoseconds answer_delay_ns) const noexcept;
  /// Share of time that all blocks at their periods take, 0-1; above 1 the periods cannot be kept.
  double planned_load() const noexcept;
  std::uint64_t transactions() const noexcept { return poller_.transactions(); }
  /// Failed transactions of a station, and the last exception that it answered.
  std::uint32_t errors(std::size_t station) const noexcept {
    return poller_.errors(stations_[station].settings().unit);
  }
  modbus::Exception last_exception(std::size_t station) const noexcept {
    return poller_.last_exception(stations_[station].settings().unit);
  }

 private:
  /// The one on the wire.
  struct Transaction {
    bool active = false;
    std::size_t station = 0;
    image::Nanoseconds arrival_ns = 0;  ///< request complete at the station
    image::Nanoseconds end_ns = 0;      ///< answer complete, or the master's patience over
    bool served = false;
    bool answered = false;
    bool damaged = false;  ///< on its way
    modbus::Request request;
    modbus::Pdu answer;
  };
  std::size_t station_of(std::uint8_t unit) const noexcept;
  image::Nanoseconds characters_ns(std::size_t count) const noexcept;
  image::Nanoseconds silence_ns() const noexcept;
  bool open(image::Nanoseconds t);
  void serve();
  void close();

  LineSettings line_;
  modbus::Poller poller_;
  modbus::Exchange exchange_;
  std::vector<ModbusStation> stations_;
  modbus::LineTally tally_;
  Transaction now_;
  bool started_ = false;
  image::Nanoseconds idle_since_ns_ = 0;
};

}  // namespace servogate::mock
