// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/socket/line_server.hpp"

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
#include "gateway/cli/options.hpp"
#include "gateway/server/socket/socket_client.hpp"
#include "gateway/server/socket/socket_path.hpp"
#include "gateway/server/texts.hpp"

namespace servogate::gateway {

namespace {

constexpr int kLinesPerTurn = 16;  ///< so that a client who floods leaves room for the others

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
  if (listen(listener_, static_cast<int>(kMostClients)) != 0 || pipe2(wake_, O_CLOEXEC) != 0)
    return text::words_of(errno);
  return {};
}

void LineServer::start() {
  thread_ = std::thread([this] { serve(); });
}

void LineServer::stop() {
  if (thread_.joinable()) {
    stop_ = true;
    const char byte = 0;
    [[maybe_unused]] const ssize_t ignored = write(wake_[1], &byte, 1);
    thread_.join();
  }
  if (wake_[0] >= 0) unlink(path_.c_str());  // bound by us
  for (int* fd : {&listener_, &wake_[0], &wake_[1]}) {
    if (*fd >= 0) close(*fd);
    *fd = -1;
  }
}

void LineServer::serve() {
  while (!stop_) {
    std::vector<pollfd> fds{{wake_[0], POLLIN, 0}, {listener_, POLLIN, 0}};
    bool backlog = false, jogs = false;
    for (const Client& c : clients_) {
      const bool reads = !c.closing && !c.backlog;
      fds.push_back({c.fd, static_cast<short>((reads ? POLLIN : 0) | (c.output.empty() ? 0 : POLLOUT)), 0});
      backlog = backlog || c.backlog;
      jogs = jogs || !c.connection.jogs.empty();
    }
    if (poll(fds.data(), fds.size(), backlog ? 0 : look_after_ms(jogs)) < 0 && errno != EINTR) break;
    if (fds[0].revents != 0) break;
    for (std::size_t i = clients_.size(); i-- > 0;) {
      if (serve_client(clients_[i], fds[i + 2].revents)) continue;
      let_go(clients_[i].connection);
      close(clients_[i].fd);
      clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (fds[1].revents != 0) accept_client();
    look();
  }
  ended();
  for (Client& c : clients_) {
    write_client(c);
    let_go(c.connection);
  }
}

/// False: the client is gone, or is to go.
bool LineServer::serve_client(Client& client, short events) {
  if ((events & (POLLERR | POLLNVAL)) != 0) return false;
  if ((events & (POLLIN | POLLHUP)) != 0 && !read_client(client)) return false;
  if (!client.input.empty()) answer_lines(client);
  watch(client.connection);
  return write_client(client) && !(client.closing && client.output.empty());
}

void LineServer::accept_client() {
  const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  clients_.emplace_back();
  Client& client = clients_.back();
  client.fd = fd;
  client.connection.number = ++connections_;
  client.connection.user = user_of(fd);
  if (clients_.size() <= kMostClients) return;
  client.output =
      refuse(says::kFull, {std::to_string(kMostClients)}, kInfrastructure, text::user_language()).line + "\n";
  write_client(client);
  let_go(client.connection);
  close(client.fd);
  clients_.pop_back();
}

bool LineServer::read_client(Client& client) {
  char buffer[16384];
  const ssize_t got = recv(client.fd, buffer, sizeof buffer, 0);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  if (got == 0) return false;
  client.input.append(buffer, static_cast<std::size_t>(got));
  return true;
}

void LineServer::answer_lines(Client& client) {
  client.backlog = false;
  std::size_t begin = 0;
  for (int n = 0; n < kLinesPerTurn && !client.closing; ++n) {
    const std::size_t end = client.input.find('\n', begin);
    const std::size_t length = (end == std::string::npos ? client.input.size() : end) - begin;
    if (length > kLongestLine) return refuse_long_line(client);
    if (end == std::string::npos) break;
    std::string_view line(client.input.data() + begin, length);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    const Reply reply = answer(line, client.connection);
    client.output += reply.line + "\n";
  }
  client.input.erase(0, begin);
  client.backlog = client.input.find('\n') != std::string::npos;
}

void LineServer::refuse_long_line(Client& client) {
  client.output +=
      refuse(says::kLongLine, {std::to_string(kLongestLine)}, kWrongUse, text::user_language()).line + "\n";
  client.input.clear();
  client.closing = true;
}

bool LineServer::write_client(Client& client) {
  while (!client.output.empty()) {
    const ssize_t sent =
        ::send(client.fd, client.output.data(), client.output.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) break;
    if (sent <= 0) return false;
    client.output.erase(0, static_cast<std::size_t>(sent));
  }
  return client.output.size() <= kMostUnread;
}

}  // namespace servogate::gateway
