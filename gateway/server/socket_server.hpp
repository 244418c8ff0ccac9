// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <string>

#include "gateway/server/desk/desk_thread.hpp"
#include "gateway/server/desk/urgent_desk.hpp"
#include "gateway/server/shut_down.hpp"
#include "gateway/server/socket/line_server.hpp"

namespace servogate::gateway {

/// The socket of a resident control. Its own thread reads lines, serves what is urgent and waits for nothing;
/// all else goes to the desk's thread. The axis that a client jogs stops when its connection ends.
class SocketServer final : public LineServer {
 public:
  SocketServer(Resident& resident, std::string path);
  ~SocketServer() override;

  /// Starts both threads; only after bind().
  void start();
  /// A client asked the control to end.
  bool down_requested() const noexcept { return down_.load(); }
  /// Begins the end of the control: its axes and spindles come to rest, while clients may look on. Any
  /// thread.
  void shut_down() noexcept;
  /// They rest, or were waited for long enough.
  bool at_rest() const noexcept { return at_rest_.load(); }
  /// After at_rest(): nothing turns or is on, as far as can be seen.
  bool rests() const noexcept { return shut_down_.rests(); }

 private:
  std::optional<Reply> answer(std::string_view line, Connection& connection, const Ticket& ticket) override;
  bool urgent(std::string_view line) const override;
  void leaves(const Reply& reply, Connection* connection) override;
  void let_go(Connection& connection) override;
  void watch(Connection& connection) override;
  void look() override;
  int look_after_ms(bool jogs) const override;
  void ended() override;

  Resident& resident_;
  std::atomic<bool> down_{false}, shuts_down_{false}, at_rest_{false};
  ShutDown shut_down_;
  UrgentDesk urgent_;
  DeskThread desk_;
};

}  // namespace servogate::gateway
