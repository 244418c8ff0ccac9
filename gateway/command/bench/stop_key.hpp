// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <termios.h>

#include <optional>

namespace servogate::gateway::command {

/// Any key of the terminal in front of which the operator sits. While it lives keys come at once and are not
/// shown. Without a terminal, or in its background, no key ever comes. Not real-time safe.
class StopKey {
 public:
  StopKey();
  ~StopKey();
  StopKey(const StopKey&) = delete;
  StopKey& operator=(const StopKey&) = delete;
  /// A key has been pressed since it lives. Never waits.
  bool pressed() const;
  /// There is a terminal whose keys come.
  bool listening() const noexcept { return before_.has_value(); }

 private:
  std::optional<termios> before_;
  mutable bool pressed_ = false;
};

}  // namespace servogate::gateway::command
