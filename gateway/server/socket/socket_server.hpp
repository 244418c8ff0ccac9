// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "gateway/server/dispatch.hpp"
#include "gateway/server/resident.hpp"
#include "gateway/server/shut_down.hpp"

namespace servogate::gateway {

/// The control socket: a Unix stream socket (owner only), one JSON object a line each way, served by one
/// thread that never waits for a client: what a client does not read is kept up to a limit, then the client
/// is let go. The axis that a client jogs stops when its connection ends.
class SocketServer {
 public:
  static constexpr std::size_t kMostClients = 32;
  static constexpr std::size_t kLongestLine = 64 * 1024;  ///< bytes of a request without its line feed
  static constexpr std::size_t kMostUnread = 1024 * 1024;

  SocketServer(Resident& resident, std::string path);
  /// Closes what connections stop() has left.
  ~SocketServer();

  /// Takes the socket's name; nothing is served yet. Empty: done; otherwise what went wrong (another control
  /// already listens there ...).
  std::string bind();
  /// Starts the thread; only after bind().
  void start();
  /// A client asked the control to end.
  bool down_requested() const noexcept { return down_.load(); }
  /// Begins the end of the control: its axes and spindles come to rest, while clients may look on.
  void shut_down() noexcept { shuts_down_ = true; }
  /// They rest, or were waited for long enough.
  bool at_rest() const noexcept { return at_rest_.load(); }
  /// After at_rest(): nothing turns or is on, as far as can be seen.
  bool rests() const noexcept { return shut_down_.rests(); }
  /// Ends the thread and removes the socket. The connections are answered no longer, but stay open until the
  /// destructor: their end tells clients that the control has put everything away.
  void stop();

 private:
  struct Client {
    int fd = -1;
    std::string input, output;
    Connection connection;
    bool backlog = false;  ///< whole lines are left from the last turn
    bool closing = false;  ///< to be closed as soon as its answers have left
  };
  void serve();
  void accept_client();
  bool read_client(Client& client);
  bool write_client(Client& client);
  void answer_lines(Client& client);
  void refuse_long_line(Client& client);
  void let_go(Client& client);

  Resident& resident_;
  std::string path_;
  int listener_ = -1;
  int wake_[2] = {-1, -1};
  std::vector<Client> clients_;
  std::uint64_t connections_ = 0;  ///< so far; their numbers count from 1
  std::atomic<bool> stop_{false}, down_{false}, shuts_down_{false}, at_rest_{false};
  ShutDown shut_down_;
  std::thread thread_;
};

}  // namespace servogate::gateway
