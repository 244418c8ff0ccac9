// SPDX-License-Identifier: Apache-2.0
#include "plc/logic/retained_memory.hpp"

#include <algorithm>
#include <cstring>

namespace servogate::plc {

std::uint64_t RetainedMemory::word(std::size_t index) const noexcept {
  std::uint64_t w = 0;
  std::memcpy(&w, newest_.data() + index * 8, std::min<std::size_t>(8, newest_.size() - index * 8));
  return w;
}

void RetainedMemory::publish() noexcept {
  const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
  std::size_t first = 0;
  if (sequence != 0)
    while (first < words_.size() && words_[first].load(std::memory_order_relaxed) == word(first)) ++first;
  if (sequence != 0 && first == words_.size()) return;
  sequence_.store(sequence + 1, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  for (std::size_t i = first; i < words_.size(); ++i) words_[i].store(word(i), std::memory_order_relaxed);
  sequence_.store(sequence + 2, std::memory_order_release);
}

std::uint64_t RetainedMemory::read(std::vector<std::uint8_t>& out) const {
  out.resize(newest_.size());
  for (;;) {
    const std::uint64_t before = sequence_.load(std::memory_order_acquire);
    if ((before & 1) != 0) continue;
    for (std::size_t i = 0; i < words_.size(); ++i) {
      const std::uint64_t w = words_[i].load(std::memory_order_relaxed);
      std::memcpy(out.data() + i * 8, &w, std::min<std::size_t>(8, out.size() - i * 8));
    }
    std::atomic_thread_fence(std::memory_order_acquire);
    if (sequence_.load(std::memory_order_relaxed) == before) return before / 2;
  }
}

}  // namespace servogate::plc
