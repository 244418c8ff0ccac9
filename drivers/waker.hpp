// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace servogate::drivers {

/// Ends waits of a thread from another one: the thread polls descriptor() beside what it waits for.
class Waker {
 public:
  Waker() : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (event_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  ~Waker() { ::close(event_); }
  Waker(const Waker&) = delete;
  Waker& operator=(const Waker&) = delete;
  /// There is something to do. One system call that never waits; from any thread. real-time safe.
  void wake() noexcept {
    const std::uint64_t one = 1;
    if (::write(event_, &one, sizeof one) < 0) return;  // the counter is full: it is readable
  }
  /// The thread shall end.
  void end() noexcept {
    ended_.store(true, std::memory_order_release);
    wake();
  }
  bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  void clear() noexcept {
    std::uint64_t told = 0;
    if (::read(event_, &told, sizeof told) < 0) return;
  }
  int descriptor() const noexcept { return event_; }

 private:
  int event_;
  std::atomic<bool> ended_{false};
};

}  // namespace servogate::drivers
