// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/un.h>

#include <string>
#include <string_view>

namespace servogate::gateway {

/// The address of a socket file; false: the path is too long for one.
bool socket_address(const std::string& path, sockaddr_un& address);

/// A client's connection to the control socket. Blocking; for one thread.
class SocketClient {
 public:
  SocketClient() = default;
  ~SocketClient();
  SocketClient(const SocketClient&) = delete;
  SocketClient& operator=(const SocketClient&) = delete;

  /// Empty: connected; otherwise the system's words.
  std::string connect(const std::string& path);
  /// Sends a line and waits for the answer line. False: the connection is gone.
  bool exchange(const std::string& line, std::string& answer);
  /// Sends bytes as they are / waits for one line, at most `patience_ms` (-1: for ever).
  bool send(std::string_view bytes);
  bool receive(std::string& line, int patience_ms = -1);

 private:
  int fd_ = -1;
  std::string input_;
};

}  // namespace servogate::gateway
