// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <csignal>

namespace servogate::gateway::command {

/// Ctrl-C and SIGTERM end a command that would otherwise run on: its loop asks ended(). Waiting system calls
/// are interrupted. One a process.
class EndBySignal {
 public:
  EndBySignal() {
    struct sigaction action {};
    action.sa_handler = [](int) { ended_ = 1; };
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
  }
  bool ended() const noexcept { return ended_ != 0; }

 private:
  static inline volatile std::sig_atomic_t ended_ = 0;
};

}  // namespace servogate::gateway::command
