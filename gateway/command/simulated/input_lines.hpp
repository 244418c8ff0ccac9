// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

namespace servogate::gateway::command {

/// Lines of standard input as they come, without waiting for any. A process in the background of a terminal
/// leaves its input alone.
class InputLines {
 public:
  /// `listening` false: there are none.
  explicit InputLines(bool listening);
  /// Of a longer line only so many characters are kept: no command is that long.
  static constexpr std::size_t kMostOfLine = 4096;

  /// The next whole line without its end; nullopt: none has come yet. However much comes, a call reads a
  /// bounded part of it.
  std::optional<std::string> next();
  /// For poll(2): -1 when standard input is not listened to just now.
  int descriptor() const;

 private:
  void read();
  void take(std::string_view bytes);

  std::string input_;  ///< up to the end of the line that is coming
  std::deque<std::string> lines_;
  bool listening_;
};

}  // namespace servogate::gateway::command
