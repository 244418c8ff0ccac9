// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/stop_key.hpp"

#include <poll.h>
#include <unistd.h>

namespace servogate::gateway::command {

StopKey::StopKey() {
  termios now{};
  if (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) != getpgrp()) return;
  if (tcgetattr(STDIN_FILENO, &now) != 0) return;
  before_ = now;
  now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &now);
}

StopKey::~StopKey() {
  if (before_) tcsetattr(STDIN_FILENO, TCSAFLUSH, &*before_);
}

bool StopKey::pressed() const {
  if (!before_ || pressed_) return pressed_;
  pollfd p{STDIN_FILENO, POLLIN, 0};
  char key = 0;
  if (poll(&p, 1, 0) > 0 && (p.revents & POLLIN) != 0) pressed_ = read(STDIN_FILENO, &key, 1) == 1;
  return pressed_;
}

}  // namespace servogate::gateway::command
