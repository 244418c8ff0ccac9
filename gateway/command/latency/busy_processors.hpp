// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <thread>
#include <vector>

namespace servogate::gateway::command {

/// Keeps processors and memory busy as long as it lives: a thread of usual priority for every processor. Not
/// real-time safe.
class BusyProcessors {
 public:
  explicit BusyProcessors(bool wanted);
  ~BusyProcessors();
  BusyProcessors(const BusyProcessors&) = delete;
  BusyProcessors& operator=(const BusyProcessors&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace servogate::gateway::command
