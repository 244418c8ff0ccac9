// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <thread>

namespace servogate::tests {

/// How long a test waits for what must come: longer than any computer stalls. Nothing is judged by it.
inline constexpr std::chrono::minutes kPatience{2};

/// Waits until `met()`, which it asks every `pause`; false: it has not come, whatever the computer.
template <typename Met>
bool comes(Met&& met, std::chrono::microseconds pause = std::chrono::milliseconds(5)) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!met()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(pause);
  }
  return true;
}

}  // namespace servogate::tests
