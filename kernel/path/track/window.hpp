// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "kernel/path/track/track.hpp"

namespace servogate::path {

/// The follower's end of the track: entries that were taken over and are not done, in order. Those of a batch
/// are staged until the last of them is there. The constructor allocates; the rest is real-time safe.
class Window final : public Ahead {
 public:
  explicit Window(const Track& track) : slots_(track.entries.capacity()) {}

  bool full() const noexcept { return staged_ - first_ >= slots_.size(); }
  bool empty() const noexcept { return first_ == last_; }
  bool anything_staged() const noexcept { return staged_ != first_; }

  void stage(const Entry& entry) noexcept;
  /// The span of that number gets its new terms. True when it is the first entry.
  bool revise(const Span& update) noexcept;
  const Entry& front() const noexcept { return slots_[front_]; }
  void pop() noexcept {
    ++first_;
    front_ = front_ + 1 < slots_.size() ? front_ + 1 : 0;
  }
  void clear() noexcept {
    first_ = last_ = staged_;
    front_ = first_ % slots_.size();
  }
  /// Everything staged counts as there, batch or not: it will not be driven.
  void release() noexcept { last_ = staged_; }

  const Span* span(int n) const noexcept override {
    const auto beyond = static_cast<std::uint64_t>(n);
    if (first_ + beyond >= last_) return nullptr;
    const std::uint64_t at = front_ + beyond;
    const Entry& entry = slots_[at < slots_.size() ? at : at - slots_.size()];
    return entry.kind == Entry::Kind::span ? &entry.span : nullptr;
  }

 private:
  Entry& at(std::uint64_t n) noexcept { return slots_[n % slots_.size()]; }

  std::vector<Entry> slots_;            ///< a ring
  std::uint64_t first_ = 0, last_ = 0;  ///< entries in use
  std::uint64_t staged_ = 0;            ///< end of those that wait for the rest of their batch, >= last_
  std::uint64_t front_ = 0;             ///< slot of the first
};

}  // namespace servogate::path
