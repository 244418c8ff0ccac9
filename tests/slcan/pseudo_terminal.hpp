// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace servogate::slcan {

/// A serial line between two programs of this computer: one opens path(), the other has far().
class PseudoTerminal {
 public:
  PseudoTerminal() {
    char name[128];
    if (openpty(&far_, &near_, name, nullptr, nullptr) != 0) throw std::runtime_error("no pseudo-terminal");
    termios raw{};
    tcgetattr(near_, &raw);
    cfmakeraw(&raw);
    tcsetattr(near_, TCSANOW, &raw);
    path_ = name;
  }
  ~PseudoTerminal() { close(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  const std::string& path() const { return path_; }
  int far() const { return far_; }
  /// The line is gone for both.
  void close() {
    for (int* end : {&near_, &far_})
      if (*end >= 0) ::close(std::exchange(*end, -1));
  }

 private:
  int far_ = -1, near_ = -1;
  std::string path_;
};

}  // namespace servogate::slcan
