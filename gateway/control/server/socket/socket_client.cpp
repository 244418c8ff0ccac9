// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/socket/socket_client.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "firmware_if/text/system_words.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

bool socket_address(const std::string& path, sockaddr_un& address) {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return true;
}

SocketClient::~SocketClient() {
  if (fd_ >= 0) close(fd_);
}

std::string SocketClient::connect(const std::string& path) {
  sockaddr_un address{};
  if (!socket_address(path, address)) return text::render(says::kPathTooLong, {}, text::user_language());
  fd_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd_ < 0 || ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return text::words_of(errno);
  return {};
}

bool SocketClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

bool SocketClient::receive(std::string& line, int patience_ms) {
  for (;;) {
    if (const std::size_t end = input_.find('\n'); end != std::string::npos) {
      line = input_.substr(0, end);
      input_.erase(0, end + 1);
      return true;
    }
    pollfd in{fd_, POLLIN, 0};
    const int ready = poll(&in, 1, patience_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    char buffer[4096];
    const ssize_t got = recv(fd_, buffer, sizeof buffer, 0);
    if (got <= 0) return false;
    input_.append(buffer, static_cast<std::size_t>(got));
  }
}

bool SocketClient::exchange(const std::string& line, std::string& answer) {
  // A server that does not take the request may have said why before it closed.
  send(line + "\n");
  return receive(answer);
}

}  // namespace servogate::gateway
