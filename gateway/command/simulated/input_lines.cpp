// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/input_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <utility>

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
  constexpr int kReadsAtOnce = 16;
  pollfd p{descriptor(), POLLIN, 0};
  for (int n = 0; n < kReadsAtOnce && p.fd >= 0 && poll(&p, 1, 0) > 0; ++n) {
    char bytes[1024];
    const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (got <= 0) {
      listening_ = false;
      return;
    }
    take({bytes, static_cast<std::size_t>(got)});
  }
}

void InputLines::take(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    const std::string_view part = bytes.substr(0, end);
    input_.append(part.substr(0, kMostOfLine - input_.size()));
    if (end == std::string_view::npos) return;
    lines_.push_back(std::move(input_));
    input_.clear();
    bytes.remove_prefix(end + 1);
  }
}

std::optional<std::string> InputLines::next() {
  if (lines_.empty() && listening_) read();
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

}  // namespace servogate::gateway::command
