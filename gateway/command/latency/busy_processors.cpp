// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/latency/busy_processors.hpp"

#include <algorithm>
#include <cstdint>

namespace servogate::gateway::command {

BusyProcessors::BusyProcessors(bool wanted) {
  const unsigned n = wanted ? std::max(1u, std::thread::hardware_concurrency()) : 0;
  for (unsigned i = 0; i < n; ++i)
    threads_.emplace_back([this] {
      std::vector<std::uint64_t> memory(std::size_t{1} << 18, 1);  // 2 MiB, beyond a cache of a core
      for (std::size_t at = 0; !stop_.load(std::memory_order_relaxed); at = (at + 4099) % memory.size())
        memory[at] = memory[(at * 7 + 1) % memory.size()] * 6364136223846793005u + 1;
    });
}

BusyProcessors::~BusyProcessors() {
  stop_ = true;
  for (std::thread& t : threads_) t.join();
}

}  // namespace servogate::gateway::command
