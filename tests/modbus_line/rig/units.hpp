// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/mock/modbus/station.hpp"

namespace servogate::modbus_line {

using Bytes = std::vector<std::uint8_t>;

/// A request as it came over the wire.
struct Asked {
  int connection = 0;             ///< counts from 0
  std::uint16_t transaction = 0;  ///< TCP
  std::uint8_t unit = 0;
  Bytes pdu;
  image::Nanoseconds t_ns = 0;  ///< CLOCK_MONOTONIC
  std::uint8_t function() const { return pdu.at(0); }
};

/// What is sent for a request.
struct Reply {
  Bytes bytes;  ///< as on the wire; empty: nothing
  image::Nanoseconds delay_ns = 0;
  bool hang_up = false;  ///< TCP: the connection is closed behind them
};

/// Simulated stations that answer on a thread of their own, over TCP on loopback or on a pseudo terminal.
class Units {
 public:
  enum class Wire { tcp, rtu };
  /// `bend` may change what is sent: it gets the request and the good answer's PDU, empty where no unit has
  /// that address. frame() makes bytes of a PDU. It is called by the thread.
  using Bend = std::function<Reply(const Asked&, const Bytes& good)>;

  explicit Units(Wire wire, const std::vector<std::uint8_t>& units = {1});
  /// One unit of this kind; an inverter with requests of its own hears no others.
  Units(const mock::StationSettings& unit, Wire wire);
  ~Units();
  Units(const Units&) = delete;
  Units& operator=(const Units&) = delete;

  std::string port() const { return std::to_string(port_); }
  const std::string& device() const { return device_; }  ///< of the pseudo terminal

  void bend(Bend bend);
  /// The good answer as it is.
  void straighten() { bend(nullptr); }
  /// TCP: ends all connections, and takes no more until plug().
  void unplug();
  void plug();

  Bytes frame(const Asked& asked, const Bytes& pdu) const;
  void with(std::uint8_t unit, const std::function<void(mock::ModbusStation&)>& act);
  bool output(std::uint8_t unit, std::uint16_t n);
  std::vector<Asked> asked() const;
  std::size_t asked_of(std::uint8_t unit) const;

 private:
  struct Connection {
    int fd = -1, number = 0;
    Bytes received;
  };
  struct Pending {
    Reply reply;
    int connection = 0;
    image::Nanoseconds due_ns = 0;
  };
  void work();
  void listen();
  void accept_one();
  /// False: it has ended.
  bool read(Connection& connection);
  bool take_request(Connection& connection, Asked& asked) const;
  void answer(const Asked& asked);
  image::Nanoseconds send_due();
  void close_all();

  void begin();

  Wire wire_;
  bool counted_ = false;  ///< requests say themselves how long they are
  std::uint16_t port_ = 0;
  std::string device_;
  int listening_ = -1, slave_ = -1;
  mutable std::mutex lock_;
  std::map<std::uint8_t, mock::ModbusStation> stations_;
  Bend bend_;
  bool plugged_ = true;
  std::vector<Asked> asked_;
  std::vector<Connection> connections_;
  std::vector<Pending> pending_;
  int next_connection_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Modbus CRC behind a frame.
Bytes with_crc(Bytes frame);

}  // namespace servogate::modbus_line
