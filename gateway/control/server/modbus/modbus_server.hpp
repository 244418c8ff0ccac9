// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/modbus/tcp_server.hpp"
#include "gateway/control/server/desk/desk_client.hpp"
#include "gateway/control/server/modbus/register_map.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// The Modbus TCP server of a running control, a client of its desk with the name "modbus". Not from a cycle.
class ModbusServer {
 public:
  /// nullptr: it cannot listen, `why` says what is wrong. Before the desk ends it has to.
  static std::unique_ptr<ModbusServer> open(const machine::ModbusServerConfig& config, Desk& desk,
                                            drivers::Notice& why);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  std::uint16_t port() const noexcept { return server_->port(); }

 private:
  explicit ModbusServer(const machine::ModbusServerConfig& config, Desk& desk);
  modbus::Response answer(const modbus::Request& asked);
  modbus::Response write(const modbus::Request& asked);

  std::vector<ByteRange> open_;
  std::mutex seen_lock_;
  std::unique_ptr<image::ProcessImage> seen_;  ///< nullptr: no cycle yet
  SeenAlarms alarms_;
  DeskClient client_;
  std::unique_ptr<modbus::TcpServer> server_;
};

}  // namespace servogate::gateway
