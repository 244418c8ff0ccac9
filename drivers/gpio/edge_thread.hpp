// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "drivers/gpio/chip.hpp"
#include "drivers/gpio/quadrature.hpp"
#include "drivers/waker.hpp"

namespace servogate::gpio {

/// An encoder with two tracks on two lines of a request.
struct Encoder {
  std::size_t a = 0, b = 0;
};

/// Takes the edges of a request as the kernel gives them, in a thread of its own, and keeps them for the
/// cycle; encoders are counted in the thread. The cycle never waits and the thread never waits for the cycle:
/// what finds no room is dropped and counted. Lost edges are noticed three ways: by the kernel's numbers, by
/// two edges of a line to the same level, and by a full queue.
class EdgeThread {
 public:
  static constexpr std::size_t kRoom = 1024;  ///< edges that wait for the cycle

  /// `inputs` outlives it. `told`: for each line of the request whether the cycle gets its edges. Not
  /// real-time safe.
  EdgeThread(InputLines& inputs, std::vector<bool> told, const std::vector<Encoder>& encoders);
  ~EdgeThread();
  EdgeThread(const EdgeThread&) = delete;
  EdgeThread& operator=(const EdgeThread&) = delete;

  // Of the cycle, real-time safe:
  /// The oldest edge that waits. false: none does.
  bool take(LineEvent& event) noexcept;
  std::int32_t count(std::size_t encoder) const noexcept {
    return encoders_[encoder].count.load(std::memory_order_acquire);
  }
  /// Edges that no cycle will see and no encoder has counted, since the start.
  std::uint32_t lost() const noexcept { return lost_.load(std::memory_order_acquire); }
  /// Transitions of encoders that no turning encoder makes, since the start.
  std::uint32_t encoder_errors() const noexcept { return errors_.load(std::memory_order_acquire); }
  /// Edges that the kernel has given, since the start.
  std::uint64_t taken() const noexcept { return taken_.load(std::memory_order_acquire); }
  /// The chip has gone: no more edges will come.
  bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }

 private:
  struct Line {
    bool told = false;
    int encoder = -1;
    bool track_b = false;
    std::uint32_t number = 0;  ///< of its last edge
    bool level = false;
    bool ahead = false;  ///< its level was read, and the edge that led there may still come
  };
  struct Counter {
    Encoder lines;
    OrderedQuadrature decoder;  ///< the thread's
    std::atomic<std::int32_t> count{0};
    bool doubt = false;  ///< the thread's: edges are missing
  };
  void work() noexcept;
  void take_in(const LineEvent& event) noexcept;
  void count_in(Line& line, const LineEvent& event) noexcept;
  void settle_doubt() noexcept;
  void keep(const LineEvent& event) noexcept;
  void lose(std::uint32_t edges) noexcept { lost_.fetch_add(edges, std::memory_order_acq_rel); }
  void show(Counter& counter) noexcept;

  InputLines& inputs_;
  std::vector<Line> lines_;
  std::vector<Counter> encoders_;
  std::array<LineEvent, kRoom> queue_{};
  std::atomic<std::uint32_t> head_{0}, tail_{0};  ///< written by the thread; taken by the cycle
  std::atomic<std::uint32_t> lost_{0}, errors_{0};
  std::atomic<std::uint64_t> taken_{0};
  std::atomic<bool> ended_{false};
  drivers::Waker waker_;
  std::thread thread_;
};

}  // namespace servogate::gpio
