// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sched.h>

namespace servogate::tests {

/// Keeps this thread, and every process that it starts meanwhile, on the processor where it runs. Processes
/// that take turns lose nothing by it and need not wake another processor at each turn.
class OneProcessor {
 public:
  OneProcessor() {
    cpu_set_t one;
    CPU_ZERO(&one);
    const int here = sched_getcpu();
    if (here < 0 || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
    CPU_SET(here, &one);
    is_pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
  }
  ~OneProcessor() {
    if (is_pinned_) sched_setaffinity(0, sizeof before_, &before_);
  }
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

 private:
  cpu_set_t before_{};
  bool is_pinned_ = false;
};

}  // namespace servogate::tests
