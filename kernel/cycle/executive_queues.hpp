// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <readerwriterqueue/readerwriterqueue.h>

#include <array>
#include <atomic>

#include "kernel/cycle/boundary/clocks.hpp"
#include "kernel/cycle/executive.hpp"

namespace servogate::cycle {

/// The two queues between the cycle and the one thread that speaks for everybody outside. Sized once; the
/// cycle only uses the calls that never allocate.
struct Cycle::Queues {
  static constexpr std::size_t kMost = 256;

  struct Posted {
    image::Request request;
    Claim claim = 0;
    image::Nanoseconds since_ns = 0;  ///< of the request clock: from then on it lies
    image::Nanoseconds limit_ns = kForAnyTime;
  };
  /// Decides once whose a posted request is: the cycle's, which takes it, or its poster's, who withdraws it.
  bool take(Claim claim) noexcept {
    return open[claim % kMost].compare_exchange_strong(claim, 0, std::memory_order_acq_rel);
  }

  moodycamel::ReaderWriterQueue<Posted> requests{kMost};
  moodycamel::ReaderWriterQueue<image::Answer> answers{kMost};
  std::array<std::atomic<Claim>, kMost> open{};  ///< claims that nobody has taken yet
  Claim last_claim = 0;                          ///< the posting thread's
  MonotonicClock wall;
};

}  // namespace servogate::cycle
