// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/wake_up.hpp"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <thread>

#include "drivers/clock.hpp"

namespace servogate::gateway::command {
namespace {

/// Keeps processors and memory busy as long as it lives.
class Load {
 public:
  explicit Load(bool wanted) {
    const unsigned n = wanted ? std::max(1u, std::thread::hardware_concurrency()) : 0;
    for (unsigned i = 0; i < n; ++i)
      threads_.emplace_back([this] {
        std::vector<std::uint64_t> memory(std::size_t{1} << 18, 1);  // 2 MiB, beyond a cache of a core
        for (std::size_t at = 0; !stop_.load(std::memory_order_relaxed); at = (at + 4099) % memory.size())
          memory[at] = memory[(at * 7 + 1) % memory.size()] * 6364136223846793005u + 1;
      });
  }
  ~Load() {
    stop_ = true;
    for (std::thread& t : threads_) t.join();
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace

WakeUp measure_wake_up(const WakeUpPlan& plan, const std::function<bool()>& ended,
                       const std::function<bool(image::Nanoseconds)>& each) {
  const Load load(plan.load);
  WakeUp out;
  std::atomic<bool> stop{false}, done{false};
  std::thread cycle([&] {
    const cycle::RealtimeThread realtime(plan.realtime);
    out.refusals = realtime.refusals();
    const auto cycles = static_cast<std::int64_t>(plan.seconds * 1e9 / static_cast<double>(plan.cycle_ns));
    image::Nanoseconds due = drivers::clock_ns(CLOCK_MONOTONIC) + 10 * plan.cycle_ns;
    for (std::int64_t n = 0; n < cycles && !stop.load(std::memory_order_relaxed); ++n, due += plan.cycle_ns) {
      const timespec until{due / image::kSecond, due % image::kSecond};
      while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
      }
      const image::Nanoseconds late = drivers::clock_ns(CLOCK_MONOTONIC) - due;
      out.late.add(late);
      if (late >= plan.cycle_ns) ++out.missed;
      if (each && !each(due)) break;
    }
    done = true;
  });
  while (!done) {
    if (ended()) stop = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  cycle.join();
  return out;
}

}  // namespace servogate::gateway::command
