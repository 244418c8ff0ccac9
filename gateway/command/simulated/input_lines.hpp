// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

namespace servogate::gateway::command {

/// Lines of standard input as they come, without waiting for any. A process in the background of a terminal
/// leaves its input alone.
class InputLines {
 public:
  /// `listening` false: there are none.
  explicit InputLines(bool listening);
  /// The next whole line without its end; nullopt: none has come yet.
  std::optional<std::string> next();
  /// For poll(2): -1 when standard input is not listened to just now.
  int descriptor() const;

 private:
  void read();

  std::string input_;
  bool listening_;
};

}  // namespace servogate::gateway::command
