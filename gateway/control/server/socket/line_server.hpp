// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "firmware_if/text/finding.hpp"

namespace servogate::gateway {

/// What the server remembers of a connection, and who derives from it.
struct Connection {
  std::uint64_t number = 0;       ///< of this connection; counts from 1
  std::string user;               ///< name of who opened it
  std::uint64_t client = 0;       ///< its number at the desk; 0: it has none yet
  std::uint64_t urgent_line = 0;  ///< that is being answered; what stands behind it waits. 0: none
  /// From then on the line at hand may have lain, in the socket or here: it was not there before.
  std::chrono::steady_clock::time_point since;
  bool ended = false;  ///< the other end has closed it: nobody waits for an answer
};

/// Which line of which connection; both count from 1.
struct LinePlace {
  std::uint64_t connection = 0, line = 0;
};

/// A Unix stream socket (owner only), one JSON object a line each way, served by one thread that never waits:
/// not for a client (what it does not read is kept up to a limit, then it is let go), and not for an answer
/// (who derives from it may give that later, from any thread). Answers leave in the order of their lines.
/// What a line means is the business of who derives from it.
class LineServer {
 public:
  static constexpr std::size_t kMostClients = 32;
  /// Further ones are let in for urgent lines alone, so that nobody can occupy the way of a stop.
  static constexpr std::size_t kMostUrgent = 16;
  static constexpr std::chrono::seconds kUrgentPatience{5};  ///< with one of them that says nothing
  static constexpr std::size_t kLongestLine = 64 * 1024;     ///< bytes of a request without its line feed
  static constexpr std::size_t kMostUnread = 1024 * 1024;
  /// Lines of one connection whose answers are not there yet; more of it is read when one has come.
  static constexpr std::size_t kMostWaiting = 64;

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
  /// Gives the answer to a line that answer() gave none to: a line without its end. Any thread.
  void reply(const LinePlace& place, std::string answer);

  // All of them are called by the server's thread.
  /// nullopt: the answer comes by reply().
  virtual std::optional<std::string> answer(std::string_view line, Connection& connection,
                                            const LinePlace& place) = 0;
  /// The line has to be heard however many clients there are.
  virtual bool urgent(std::string_view /*line*/) const { return false; }
  /// The client is gone.
  virtual void let_go(Connection&) {}

 private:
  void wake() noexcept;
  using Clock = std::chrono::steady_clock;
  /// The bytes of the input up to `end` were not there before `since`.
  struct Arrival {
    std::size_t end = 0;
    Clock::time_point since;
  };
  struct Client {
    int fd = -1;
    std::string input, output;
    std::deque<Arrival> arrivals;            ///< of what is in `input`
    Clock::time_point empty = Clock::now();  ///< the last time when nothing was left in the socket
    Connection connection;
    std::deque<std::optional<std::string>> answers;  ///< of the lines from first_line on
    std::uint64_t first_line = 1;
    Clock::time_point heard = Clock::now();
    bool backlog = false;  ///< whole lines are left from the last turn
    bool urgent_only = false;
    bool closing = false;  ///< to be closed as soon as its answers have left
  };
  void serve();
  bool serve_client(Client& client, short events);
  bool reads(const Client& client) const;
  void accept_client();
  void make_room();
  void remove(std::size_t client);
  bool read_client(Client& client);
  bool write_client(Client& client);
  void answer_lines(Client& client);
  void take_line(Client& client, std::string_view line);
  void refuse_client(Client& client, const text::Entry& entry, std::size_t limit, int exit);
  void hand_out(Client& client);
  static bool goes_on(const Client& client);
  static Clock::time_point since_of(const Client& client, std::size_t end);
  static void drop(Client& client, std::size_t bytes);
  void deliver();
  std::size_t ordinary_clients() const;

  std::string path_;
  int listener_ = -1;
  Clock::time_point nobody_ = Clock::now();  ///< the last time when nobody waited at the listener
  int wake_[2] = {-1, -1};
  std::vector<Client> clients_;
  std::uint64_t connections_ = 0;  ///< so far; their numbers count from 1
  std::mutex replies_mutex_;
  std::vector<std::pair<LinePlace, std::string>> replies_;  ///< that other threads have given
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace servogate::gateway
