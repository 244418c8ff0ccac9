// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

namespace servogate::path {

/// A bounded queue from one writer to one reader, wait-free on both sides, whose slots are read in place.
/// Positions are running numbers that never wrap. Construction allocates, nothing else does.
template <typename T>
class Ring {
 public:
  /// `kept`: how many of the slots given back last can still be read.
  explicit Ring(std::uint32_t capacity, std::uint32_t kept = 0)
      : capacity_(capacity), kept_(kept), slots_(std::size_t{capacity} + kept) {}

  /// Writer: number of slots written so far. Also what a reader may see. real-time safe.
  std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }
  /// Number of slots given back so far. real-time safe.
  std::uint64_t freed() const noexcept { return freed_.load(std::memory_order_acquire); }
  /// Reader: the first slot that can still be read. real-time safe.
  std::uint64_t oldest() const noexcept {
    const std::uint64_t gone = freed();
    return gone > kept_ ? gone - kept_ : 0;
  }
  /// Slots that can be written and not given back. real-time safe.
  std::uint32_t capacity() const noexcept { return capacity_; }

  /// Writer: what has room until let_go() is what has room now, whatever the reader gives back meanwhile: how
  /// far a writer on a thread of its own comes does not depend on when it works. real-time safe.
  void hold() noexcept {
    held_ = freed();
    holds_ = true;
  }
  void let_go() noexcept { holds_ = false; }
  /// Writer: number of slots given back, as it may know it. real-time safe.
  std::uint64_t given_back() const noexcept { return holds_ ? held_ : freed(); }

  /// Writer: false when the ring is full. real-time safe.
  bool push(const T& value) noexcept {
    const std::uint64_t at = written_.load(std::memory_order_relaxed);
    if (at - given_back() >= capacity_) return false;
    slots_[at % slots_.size()] = value;
    written_.store(at + 1, std::memory_order_release);
    return true;
  }
  /// Reader: a slot with oldest() <= number < written(). real-time safe.
  const T& operator[](std::uint64_t number) const noexcept { return slots_[number % slots_.size()]; }
  /// Reader: gives back all slots below `number`. real-time safe.
  void free_below(std::uint64_t number) noexcept { freed_.store(number, std::memory_order_release); }

 private:
  std::uint32_t capacity_, kept_;
  std::vector<T> slots_;
  std::atomic<std::uint64_t> written_{0};
  std::atomic<std::uint64_t> freed_{0};
  bool holds_ = false;  ///< the writer's, with held_
  std::uint64_t held_ = 0;
};

}  // namespace servogate::path
