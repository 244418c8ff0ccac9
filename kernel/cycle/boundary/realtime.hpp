// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace servogate::cycle {

/// What a real-time thread asks of the system.
struct RealtimeSettings {
  int priority = 80;         ///< SCHED_FIFO 1-99
  int cpu = -1;              ///< processor to stay on, -1: any
  bool best_effort = false;  ///< run without what the system refuses
};

/// One thing the system refused, with the command that grants it; its words may be of both languages
/// (text::both).
struct RealtimeRefusal {
  std::string what;    ///< "SCHED_FIFO priority 80", "locked memory", "processor 3", "/dev/cpu_dma_latency"
  std::string cause;   ///< the system's words
  std::string remedy;  ///< one command
  bool needed = true;  ///< false: only a warning, even without best effort
};

/// Turns the calling thread into the real-time thread: locks memory, pre-faults the stack, sets affinity and
/// SCHED_FIFO, holds /dev/cpu_dma_latency at 0 for as long as the object lives. Not real-time safe.
class RealtimeThread {
 public:
  explicit RealtimeThread(const RealtimeSettings& settings);
  ~RealtimeThread();
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

  const std::vector<RealtimeRefusal>& refusals() const { return refusals_; }
  /// False when something needed was refused: without best effort the control must not start.
  bool granted() const;

 private:
  std::vector<RealtimeRefusal> refusals_;
  int latency_file_ = -1;
};

}  // namespace servogate::cycle
