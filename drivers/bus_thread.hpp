// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <pthread.h>
#include <sched.h>

namespace servogate::drivers {

/// Names the calling thread, which serves an adapter, and gives it a real-time priority below the usual one
/// of the cycle, where the process may have one; else it runs as any thread. `name`: at most 15 characters.
inline void begin_bus_thread(const char* name) noexcept {
  sched_param priority{};
  priority.sched_priority = 70;
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  pthread_setname_np(pthread_self(), name);
}

}  // namespace servogate::drivers
