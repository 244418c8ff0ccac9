// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/mock/modbus/station.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/modbus/map.hpp"

namespace servogate::mock {

/// The line between master and stations, and the master's patience.
struct LineSettings {
  std::uint32_t baud = 115200;  ///< RTU: 11 bit a character, 3.5 characters of silence; 0: no line time (TCP)
  image::Nanoseconds latency_ns = 0;  ///< added to each transaction (TCP round trip)
  image::Nanoseconds answer_timeout_ns = 100 * image::kMillisecond;
  int retries = 1;  ///< repeats of an unanswered or garbled transaction before the station counts as lost
  /// How often a lost station is tried again, once and one block, so that it does not slow its neighbours.
  image::Nanoseconds lost_retry_ns = 500 * image::kMillisecond;
  /// Age from which the data of a block count as stale, in periods of the block; as lost (bad) after twice
  /// that.
  int stale_after_periods = 3;
};

/// A Modbus bus on a simulated line: one transaction at a time, real PDUs between a polling master and its
/// stations. As Simulated it lets time pass on the line; as CycleDevice it moves finished blocks into packet
/// A and takes outputs from it, never waiting. Quality, age and errors of each unit stand in image.sources.
class MockModbusLine final : public image::CycleDevice, public image::Simulated {
 public:
  /// The first station's source is `first_source` in image.sources, the next one's follows it.
  MockModbusLine(LineSettings line, modbus::Map map, std::vector<StationSettings> stations,
                 int first_source = 0);

  /// Data finished since the last cycle into the image. real-time safe.
  void receive(image::ProcessImage& image) noexcept override;
  /// Takes the outputs from the image; they go out with the block's next transaction. real-time safe.
  void send(image::ProcessImage& image) noexcept override;
  void advance_to(image::Nanoseconds t) override;

  std::size_t stations() const noexcept { return stations_.size(); }
  ModbusStation& station(std::size_t n) { return stations_[n]; }
  const modbus::Map& map() const noexcept { return map_; }
  /// Time that one fault-free transaction of a block takes on this line.
  image::Nanoseconds transaction_ns(const modbus::Block& block,
                                    image::Nanoseconds answer_delay_ns) const noexcept;
  /// Share of time that all blocks at their periods take, 0-1; above 1 the periods cannot be kept.
  double planned_load() const noexcept;
  std::uint64_t transactions() const noexcept { return transactions_; }
  /// Failed transactions of a station, and the last exception that it answered.
  std::uint32_t errors(std::size_t station) const noexcept { return health_[station].errors; }
  modbus::Exception last_exception(std::size_t station) const noexcept {
    return health_[station].last_exception;
  }

 private:
  struct BlockState {
    modbus::Data data;  ///< newest read, or next to write
    image::Nanoseconds due_ns = 0;
    image::Nanoseconds updated_ns = -1;  ///< end of the last good transaction, -1: never
    bool fresh = false;                  ///< read data not yet in the image
    bool armed = false;                  ///< write data taken from the image at least once
    bool changed = false;                ///< write data changed since they last went out
  };
  struct Health {
    std::uint32_t errors = 0;
    bool lost = false;
    image::Nanoseconds retry_ns = 0;  ///< a lost station is left alone until then
    modbus::Exception last_exception = modbus::Exception::none;
  };
  struct Transaction {
    bool active = false;
    std::size_t block = 0;
    int attempt = 0;
    image::Nanoseconds arrival_ns = 0;  ///< request complete at the station
    image::Nanoseconds end_ns = 0;      ///< answer complete, or the master's patience over
    bool served = false;
    bool answered = false;
    modbus::Request request;
    modbus::Pdu answer;
  };
  void start_at(image::Nanoseconds t);
  image::Nanoseconds characters_ns(std::size_t count) const noexcept;
  image::Nanoseconds silence_ns() const noexcept;
  ModbusStation& station_of(std::size_t block) { return stations_[block_station_[block]]; }
  Health& health_of(std::size_t block) { return health_[block_station_[block]]; }
  image::Nanoseconds ready_ns(std::size_t block) const noexcept;
  bool pick(std::size_t& block, image::Nanoseconds& start) const;
  void open(std::size_t block, image::Nanoseconds start, int attempt);
  void serve();
  void close();
  void succeed(const modbus::Response& response);
  void fail(bool worth_repeating);
  image::Quality quality(std::size_t block, image::Nanoseconds t) const noexcept;
  void update_source(std::size_t station, image::ProcessImage& image) const noexcept;

  LineSettings line_;
  modbus::Map map_;
  std::vector<ModbusStation> stations_;
  std::vector<std::size_t> block_station_;
  std::vector<BlockState> blocks_;
  std::vector<Health> health_;
  Transaction now_;
  bool started_ = false;
  image::Nanoseconds start_ns_ = 0;
  image::Nanoseconds idle_since_ns_ = 0;
  std::size_t last_block_ = 0;
  std::uint64_t transactions_ = 0;
  int first_source_;
};

}  // namespace servogate::mock
