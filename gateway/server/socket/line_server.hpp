// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "gateway/server/socket/line.hpp"

namespace servogate::gateway {

/// A Unix stream socket (owner only), one JSON object a line each way, served by one thread that never waits
/// for a client: what a client does not read is kept up to a limit, then the client is let go. What a line
/// means is the business of who derives from it.
class LineServer {
 public:
  static constexpr std::size_t kMostClients = 32;
  static constexpr std::size_t kLongestLine = 64 * 1024;  ///< bytes of a request without its line feed
  static constexpr std::size_t kMostUnread = 1024 * 1024;

  explicit LineServer(std::string path) : path_(std::move(path)) {}
  /// Closes what connections stop() has left. Who derives from it has called stop() in its own destructor.
  virtual ~LineServer();
  LineServer(const LineServer&) = delete;
  LineServer& operator=(const LineServer&) = delete;

  /// Takes the socket's name; nothing is served yet. Empty: done; otherwise what went wrong (another control
  /// already listens there ...).
  std::string bind();
  /// Starts the thread; only after bind().
  void start();
  /// Ends the thread and removes the socket. The connections are answered no longer, but stay open until the
  /// destructor: their end tells clients that the control has put everything away.
  void stop();

 protected:
  // All of them are called by the server's thread.
  virtual Reply answer(std::string_view line, Connection& connection) = 0;
  /// The client is gone.
  virtual void let_go(Connection&) {}
  /// Now and then, for each connection.
  virtual void watch(Connection&) {}
  /// Now and then, at most look_after_ms() apart.
  virtual void look() {}
  virtual int look_after_ms(bool /*a client jogs*/) const { return 200; }
  /// The thread ends.
  virtual void ended() {}

 private:
  struct Client {
    int fd = -1;
    std::string input, output;
    Connection connection;
    bool backlog = false;  ///< whole lines are left from the last turn
    bool closing = false;  ///< to be closed as soon as its answers have left
  };
  void serve();
  bool serve_client(Client& client, short events);
  void accept_client();
  bool read_client(Client& client);
  bool write_client(Client& client);
  void answer_lines(Client& client);
  void refuse_long_line(Client& client);

  std::string path_;
  int listener_ = -1;
  int wake_[2] = {-1, -1};
  std::vector<Client> clients_;
  std::uint64_t connections_ = 0;  ///< so far; their numbers count from 1
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace servogate::gateway
