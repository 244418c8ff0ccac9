// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "gateway/control/server/desk/desk.hpp"
#include "gateway/control/server/socket/line_server.hpp"

namespace servogate::gateway {

/// The socket of a resident control: each connection is a client of the desk, which it asks in lines of JSON.
/// Its own thread waits for nothing.
class SocketServer final : public LineServer {
 public:
  /// `desk`: is there until stop().
  SocketServer(Desk& desk, std::string path) : LineServer(std::move(path)), desk_(desk) {}
  ~SocketServer() override { stop(); }

 private:
  std::optional<std::string> answer(std::string_view line, Connection& connection,
                                    const LinePlace& place) override;
  bool urgent(std::string_view line) const override;
  void let_go(Connection& connection) override;

  Desk& desk_;
};

}  // namespace servogate::gateway
