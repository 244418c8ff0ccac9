// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/paced_loop.hpp"

#include <chrono>

namespace servogate::gateway {

PacedLoop::PacedLoop(double pace, const cycle::Cycle& cycle, std::function<bool()> step)
    : pace_(pace), cycle_(cycle), step_(std::move(step)), thread_([this] { run(); }) {}

PacedLoop::~PacedLoop() {
  stop_ = true;
  thread_.join();
}

void PacedLoop::run() {
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin = Clock::now();
  const double period_s = static_cast<double>(cycle_.period_ns()) * 1e-9;
  for (bool more = true; more && !stop_;) {
    const double due_s = static_cast<double>(cycle_.count()) * period_s / pace_;
    const Clock::time_point due = begin + std::chrono::nanoseconds(static_cast<std::int64_t>(due_s * 1e9));
    const Clock::time_point now = Clock::now();
    // A sleep a millisecond: faster than real time several cycles share one.
    if (due > now) std::this_thread::sleep_until(due);
    // What was lost (a slow computer, a laptop that slept) is not made up for in a burst.
    if (now > due + std::chrono::milliseconds(100)) begin += now - due;
    if (cycle_.count() % 64 == 0) std::this_thread::yield();
    more = step_();
  }
}

}  // namespace servogate::gateway
