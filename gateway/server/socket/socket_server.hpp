// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <string>

#include "gateway/server/resident.hpp"
#include "gateway/server/shut_down.hpp"
#include "gateway/server/socket/line_server.hpp"

namespace servogate::gateway {

/// The socket of a resident control. The axis that a client jogs stops when its connection ends.
class SocketServer final : public LineServer {
 public:
  SocketServer(Resident& resident, std::string path);
  ~SocketServer() override;

  /// A client asked the control to end.
  bool down_requested() const noexcept { return down_.load(); }
  /// Begins the end of the control: its axes and spindles come to rest, while clients may look on.
  void shut_down() noexcept { shuts_down_ = true; }
  /// They rest, or were waited for long enough.
  bool at_rest() const noexcept { return at_rest_.load(); }
  /// After at_rest(): nothing turns or is on, as far as can be seen.
  bool rests() const noexcept { return shut_down_.rests(); }

 private:
  Reply answer(std::string_view line, Connection& connection) override;
  void let_go(Connection& connection) override;
  void watch(Connection& connection) override;
  void look() override;
  int look_after_ms(bool jogs) const override;
  void ended() override { at_rest_ = true; }

  Resident& resident_;
  std::atomic<bool> down_{false}, shuts_down_{false}, at_rest_{false};
  ShutDown shut_down_;
};

}  // namespace servogate::gateway
