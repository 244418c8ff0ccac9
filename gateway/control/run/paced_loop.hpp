// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <functional>
#include <thread>

#include "kernel/cycle/executive.hpp"

namespace servogate::gateway {

/// Virtual time paced against the wall clock on a thread of its own, from construction to the end.
class PacedLoop {
 public:
  /// `pace`: machine seconds per wall-clock second; `step` does a cycle of `cycle`, false: the last one.
  PacedLoop(double pace, const cycle::Cycle& cycle, std::function<bool()> step);
  ~PacedLoop();
  PacedLoop(const PacedLoop&) = delete;

 private:
  void run();

  double pace_;
  const cycle::Cycle& cycle_;
  std::function<bool()> step_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace servogate::gateway
