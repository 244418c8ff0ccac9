// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/input_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include <csignal>

namespace servogate::gateway::command {

InputLines::InputLines(bool listening) : listening_(listening) {
  // A process in the background of a terminal must not be stopped for having looked at it.
  if (listening_) std::signal(SIGTTIN, SIG_IGN);
}

int InputLines::descriptor() const {
  if (!listening_) return -1;
  const bool elsewhere = isatty(STDIN_FILENO) != 0 && tcgetpgrp(STDIN_FILENO) != getpgrp();
  return elsewhere ? -1 : STDIN_FILENO;
}

void InputLines::read() {
  pollfd p{descriptor(), POLLIN, 0};
  while (p.fd >= 0 && poll(&p, 1, 0) > 0) {
    char bytes[1024];
    const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (got <= 0) {
      listening_ = false;
      return;
    }
    input_.append(bytes, static_cast<std::size_t>(got));
  }
}

std::optional<std::string> InputLines::next() {
  std::size_t end = input_.find('\n');
  if (end == std::string::npos && listening_) {
    read();
    end = input_.find('\n');
  }
  if (end == std::string::npos) return std::nullopt;
  std::string line = input_.substr(0, end);
  input_.erase(0, end + 1);
  return line;
}

}  // namespace servogate::gateway::command
