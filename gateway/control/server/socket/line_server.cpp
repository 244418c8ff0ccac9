// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/socket/line_server.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "firmware_if/text/system_words.hpp"
#include "gateway/control/server/protocol/reply_json.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/socket/socket_client.hpp"
#include "gateway/control/server/socket/socket_path.hpp"

namespace servogate::gateway {

namespace {

// At clients that say nothing. So finely is known since when something may have lain in a socket.
constexpr int kLook_ms = 10;
constexpr int kLinesPerTurn = 16;  ///< so that a client who floods leaves room for the others

/// The other end is closed; one that only says no more (shutdown) still listens.
bool hung_up(int fd) {
  pollfd end{fd, 0, 0};
  return poll(&end, 1, 0) > 0 && (end.revents & POLLHUP) != 0;
}

/// Name of who is at the other end; its number where it has none.
std::string user_of(int fd) {
  ucred who{};
  socklen_t size = sizeof who;
  if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) return {};
  passwd entry{}, *found = nullptr;
  std::array<char, 4096> room{};
  getpwuid_r(who.uid, &entry, room.data(), room.size(), &found);
  return found != nullptr ? std::string(entry.pw_name) : std::to_string(who.uid);
}

}  // namespace

LineServer::~LineServer() {
  stop();
  for (const Client& c : clients_) close(c.fd);
}

std::string LineServer::bind() {
  sockaddr_un address{};
  if (!socket_address(path_, address)) return text::render(says::kPathTooLong, {}, text::user_language());
  if (std::string problem = clear_way(path_); !problem.empty()) return problem;
  listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t before = umask(0177);
  const bool bound =
      listener_ >= 0 && ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  const int problem = errno;
  umask(before);
  if (!bound) return text::words_of(problem);
  if (listen(listener_, static_cast<int>(kMostClients + kMostUrgent)) != 0 ||
      pipe2(wake_, O_CLOEXEC | O_NONBLOCK) != 0)
    return text::words_of(errno);
  return {};
}

void LineServer::start() {
  thread_ = std::thread([this] { serve(); });
}

void LineServer::stop() {
  if (thread_.joinable()) {
    stop_ = true;
    wake();
    thread_.join();
  }
  if (wake_[0] >= 0) unlink(path_.c_str());  // bound by us
  for (int* fd : {&listener_, &wake_[0], &wake_[1]}) {
    if (*fd >= 0) close(*fd);
    *fd = -1;
  }
}

void LineServer::wake() noexcept {
  const char byte = 0;
  [[maybe_unused]] const ssize_t full_is_awake = write(wake_[1], &byte, 1);
}

void LineServer::reply(const LinePlace& place, std::string answer) {
  {
    const std::scoped_lock lock(replies_mutex_);
    replies_.emplace_back(place, std::move(answer));
  }
  wake();
}

bool LineServer::reads(const Client& client) const {
  return !client.closing && !client.backlog && goes_on(client);
}

void LineServer::serve() {
  while (!stop_) {
    std::vector<pollfd> fds{{wake_[0], POLLIN, 0}, {listener_, POLLIN, 0}};
    bool backlog = false;
    for (const Client& c : clients_) {
      fds.push_back(
          {c.fd, static_cast<short>((reads(c) ? POLLIN : 0) | (c.output.empty() ? 0 : POLLOUT)), 0});
      backlog = backlog || c.backlog;
    }
    const Clock::time_point looked = Clock::now();
    const int ready = poll(fds.data(), fds.size(), backlog ? 0 : kLook_ms);
    if (ready < 0 && errno != EINTR) break;
    if (ready >= 0 && fds[1].revents == 0) nobody_ = looked;
    for (std::size_t i = 0; ready >= 0 && i < clients_.size(); ++i)
      if ((fds[i + 2].events & POLLIN) != 0 && fds[i + 2].revents == 0) clients_[i].empty = looked;
    for (char drained[64]; read(wake_[0], drained, sizeof drained) > 0;) {
    }
    deliver();
    for (std::size_t i = clients_.size(); i-- > 0;)
      if (!serve_client(clients_[i], fds[i + 2].revents)) remove(i);
    if (fds[1].revents != 0) accept_client();
  }
  deliver();
  for (Client& c : clients_) {
    hand_out(c);
    write_client(c);
    let_go(c.connection);
  }
}

void LineServer::remove(std::size_t client) {
  let_go(clients_[client].connection);
  close(clients_[client].fd);
  clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(client));
}

/// Answers that came from elsewhere take the places of their lines; those whose client is gone have none.
void LineServer::deliver() {
  std::vector<std::pair<LinePlace, std::string>> come;
  {
    const std::scoped_lock lock(replies_mutex_);
    come.swap(replies_);
  }
  for (auto& [place, answer] : come) {
    const auto client = std::find_if(clients_.begin(), clients_.end(), [&](const Client& c) {
      return c.connection.number == place.connection;
    });
    if (client == clients_.end() || place.line < client->first_line) continue;
    if (client->connection.urgent_line == place.line) client->connection.urgent_line = 0;
    client->answers[place.line - client->first_line] = std::move(answer);
  }
}

/// False: the client is gone, or is to go.
bool LineServer::serve_client(Client& client, short events) {
  if ((events & (POLLERR | POLLNVAL)) != 0) return false;
  if ((events & (POLLIN | POLLHUP)) != 0 && !read_client(client)) return false;
  hand_out(client);
  if (!client.input.empty()) answer_lines(client);
  const bool silent = client.urgent_only && client.answers.empty() &&
                      std::chrono::steady_clock::now() - client.heard > kUrgentPatience;
  if (silent && !client.closing) refuse_client(client, says::kFull, kMostClients, kInfrastructure);
  hand_out(client);
  if (!write_client(client)) return false;
  return !client.closing || client.backlog || !client.answers.empty() || !client.output.empty();
}

/// Answers leave in the order of their lines.
void LineServer::hand_out(Client& client) {
  while (!client.answers.empty() && client.answers.front()) {
    client.output += *client.answers.front() + "\n";
    client.answers.pop_front();
    ++client.first_line;
  }
}

/// The next line may be taken: the order of answers is kept for so many, and an urgent one comes first.
bool LineServer::goes_on(const Client& client) {
  return client.answers.size() < kMostWaiting && client.connection.urgent_line == 0;
}

std::size_t LineServer::ordinary_clients() const {
  return static_cast<std::size_t>(
      std::count_if(clients_.begin(), clients_.end(), [](const Client& c) { return !c.urgent_only; }));
}

void LineServer::accept_client() {
  const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  const bool full = ordinary_clients() >= kMostClients;
  if (full) make_room();
  clients_.emplace_back();
  Client& client = clients_.back();
  client.fd = fd;
  client.empty = nobody_;
  client.urgent_only = full;
  client.connection.number = ++connections_;
  client.connection.user = user_of(fd);
}

/// The one that has been silent for the longest goes: whoever connects to stop something says so at once.
void LineServer::make_room() {
  if (clients_.size() < kMostClients + kMostUrgent) return;
  std::size_t oldest = clients_.size();
  for (std::size_t i = 0; i < clients_.size(); ++i)
    if (clients_[i].urgent_only && (oldest == clients_.size() || clients_[i].heard < clients_[oldest].heard))
      oldest = i;
  if (oldest == clients_.size()) return;
  refuse_client(clients_[oldest], says::kFull, kMostClients, kInfrastructure);
  hand_out(clients_[oldest]);
  write_client(clients_[oldest]);
  remove(oldest);
}

/// Whoever only says that no more comes (shutdown) still gets its answers. Whether the other end is closed is
/// asked behind the reading: what was read had its client then, or has not.
bool LineServer::read_client(Client& client) {
  char buffer[16384];
  const Clock::time_point now = Clock::now();
  const ssize_t got = recv(client.fd, buffer, sizeof buffer, 0);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  client.connection.ended = hung_up(client.fd);
  if (got == 0) {
    client.closing = true;
    return !client.connection.ended;
  }
  if (client.closing) return true;  // it was refused
  client.input.append(buffer, static_cast<std::size_t>(got));
  client.arrivals.push_back({client.input.size(), client.empty});
  if (static_cast<std::size_t>(got) < sizeof buffer) client.empty = now;
  client.heard = now;
  return true;
}

/// A line is there when its end is.
LineServer::Clock::time_point LineServer::since_of(const Client& client, std::size_t end) {
  const auto arrival = std::find_if(client.arrivals.begin(), client.arrivals.end(),
                                    [end](const Arrival& a) { return a.end > end; });
  return arrival != client.arrivals.end() ? arrival->since : Clock::now();
}

/// Takes what was dealt with from the front of the input.
void LineServer::drop(Client& client, std::size_t bytes) {
  client.input.erase(0, bytes);
  while (!client.arrivals.empty() && client.arrivals.front().end <= bytes) client.arrivals.pop_front();
  for (Arrival& a : client.arrivals) a.end -= bytes;
}

void LineServer::answer_lines(Client& client) {
  client.backlog = false;
  std::size_t begin = 0;
  // Behind a closed connection no turn may come any more, and no answer is waited for.
  for (int lines = 0; client.connection.ended || (lines < kLinesPerTurn && goes_on(client)); ++lines) {
    const std::size_t end = client.input.find('\n', begin);
    const std::size_t length = (end == std::string::npos ? client.input.size() : end) - begin;
    if (length > kLongestLine) return refuse_client(client, says::kLongLine, kLongestLine, kWrongUse);
    if (end == std::string::npos) break;
    std::string_view line(client.input.data() + begin, length);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    client.connection.since = since_of(client, end);
    if (client.urgent_only && ordinary_clients() < kMostClients) client.urgent_only = false;
    if (client.urgent_only && !urgent(line))
      return refuse_client(client, says::kFull, kMostClients, kInfrastructure);
    take_line(client, line);
  }
  drop(client, begin);
  hand_out(client);
  client.backlog = goes_on(client) && client.input.find('\n') != std::string::npos;
}

void LineServer::take_line(Client& client, std::string_view line) {
  const LinePlace place{client.connection.number, client.first_line + client.answers.size()};
  client.answers.emplace_back();
  client.answers.back() = answer(line, client.connection, place);
}

/// A last sentence behind the answers, then the client goes.
void LineServer::refuse_client(Client& client, const text::Entry& entry, std::size_t limit, int exit) {
  client.answers.emplace_back(line_of(refuse(entry, {std::to_string(limit)}, exit, text::user_language())));
  drop(client, client.input.size());
  client.backlog = false;
  client.closing = true;
}

bool LineServer::write_client(Client& client) {
  std::size_t sent_all = 0;
  while (sent_all < client.output.size()) {
    const ssize_t sent = ::send(client.fd, client.output.data() + sent_all, client.output.size() - sent_all,
                                MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) break;
    if (sent <= 0) return false;
    sent_all += static_cast<std::size_t>(sent);
  }
  client.output.erase(0, sent_all);
  return client.output.size() <= kMostUnread;
}

}  // namespace servogate::gateway
