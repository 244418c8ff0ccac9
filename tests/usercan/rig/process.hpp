// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <string>
#include <vector>

namespace servogate::usercan {

/// The servogate program with its arguments, as a process of its own; ended with the object.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Waits until it has said this, on either stream; half a minute at most.
  bool says(const std::string& text) const;
  /// Waits for its end; its exit code, -1 when a signal ended it.
  int wait();
  /// It has come to its end by itself.
  bool ended() const;
  void signal(int number) const;
  std::string said() const;
  /// For a failure: whether it lives or how it has ended, and what it said.
  std::string life();

 private:
  std::string file_;
  pid_t pid_;
};

}  // namespace servogate::usercan
