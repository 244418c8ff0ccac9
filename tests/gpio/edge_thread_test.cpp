// SPDX-License-Identifier: Apache-2.0
// The thread that takes edges, with a request that the test plays: on any computer.
#include "drivers/gpio/edge_thread.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <mutex>
#include <thread>

#include "drivers/gpio/cycle_times.hpp"

namespace servogate::gpio {
namespace {

using image::kMicrosecond;
using image::kMillisecond;

/// Inputs whose levels and edges the test gives.
class PlayedInputs final : public InputLines {
 public:
  bool read(std::uint64_t& levels) noexcept override {
    const std::lock_guard held(lock_);
    levels = levels_;
    return true;
  }
  int descriptor() const noexcept override { return told_.descriptor(); }
  int take(std::span<LineEvent> events) noexcept override {
    const std::lock_guard held(lock_);
    told_.clear();
    if (gone_) return -1;
    int count = 0;
    for (; !waiting_.empty() && count < static_cast<int>(events.size()); ++count) {
      events[static_cast<std::size_t>(count)] = waiting_.front();
      waiting_.pop_front();
    }
    return count;
  }
  /// A line changes; `heard` false: the kernel drops its edge but numbers it.
  void change(std::size_t line, bool heard = true) {
    const std::lock_guard held(lock_);
    levels_ ^= std::uint64_t{1} << line;
    ++numbers_[line];
    if (heard) waiting_.push_back({line, (levels_ >> line & 1u) != 0, ++time_, numbers_[line]});
    told_.wake();
  }
  /// A line changes and comes back before its interrupt is served: one edge, to the level it had.
  void flicker(std::size_t line) {
    const std::lock_guard held(lock_);
    waiting_.push_back({line, (levels_ >> line & 1u) != 0, ++time_, ++numbers_[line]});
    told_.wake();
  }
  void vanish() {
    const std::lock_guard held(lock_);
    gone_ = true;
    told_.wake();
  }

 private:
  std::mutex lock_;
  drivers::Waker told_;
  std::deque<LineEvent> waiting_;
  std::uint64_t levels_ = 0;
  std::uint32_t numbers_[4]{};
  image::Nanoseconds time_ = 0;
  bool gone_ = false;
};

/// However long the thread needs.
template <typename Condition>
void wait_for(Condition&& condition) {
  while (!condition()) std::this_thread::yield();
}

TEST(EdgeThread, hands_edges_to_the_cycle_in_their_order_with_the_times_of_the_kernel) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {true, true}, {});
  inputs.change(0);
  inputs.change(1);
  inputs.change(0);
  wait_for([&] { return edges.taken() == 3; });
  LineEvent e;
  ASSERT_TRUE(edges.take(e));
  EXPECT_EQ(e.line, 0u);
  EXPECT_TRUE(e.level);
  EXPECT_EQ(e.t_ns, 1);
  ASSERT_TRUE(edges.take(e));
  EXPECT_EQ(e.line, 1u);
  ASSERT_TRUE(edges.take(e));
  EXPECT_FALSE(e.level);
  EXPECT_EQ(e.t_ns, 3);
  EXPECT_FALSE(edges.take(e));
  EXPECT_EQ(edges.lost(), 0u);
}

TEST(EdgeThread, counts_what_the_kernel_dropped_by_its_numbers) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {true}, {});
  for (int n = 0; n < 5; ++n) inputs.change(0, false);
  inputs.change(0);
  wait_for([&] { return edges.taken() == 1; });
  wait_for([&] { return edges.lost() == 5; });
}

TEST(EdgeThread, counts_an_edge_that_an_interrupt_has_missed_by_two_of_the_same_level) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {true}, {});
  inputs.change(0);
  inputs.flicker(0);
  wait_for([&] { return edges.taken() == 2; });
  wait_for([&] { return edges.lost() == 1; });
}

TEST(EdgeThread, drops_and_counts_what_no_cycle_fetches) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {true}, {});
  const auto all = static_cast<std::uint64_t>(EdgeThread::kRoom) + 100;
  for (std::uint64_t n = 0; n < all; ++n) inputs.change(0);
  wait_for([&] { return edges.taken() == all; });
  wait_for([&] { return edges.lost() == 100; });
  LineEvent e;
  std::size_t fetched = 0;
  while (edges.take(e)) ++fetched;
  EXPECT_EQ(fetched, EdgeThread::kRoom);
}

TEST(EdgeThread, counts_an_encoder_and_tells_the_cycle_none_of_its_edges) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {false, false}, {{0, 1}});
  for (int n = 0; n < 1000; ++n) inputs.change(static_cast<std::size_t>(n % 2));
  wait_for([&] { return edges.count(0) == 1000; });
  LineEvent e;
  EXPECT_FALSE(edges.take(e));
  EXPECT_EQ(edges.encoder_errors(), 0u);
}

TEST(EdgeThread, finds_the_place_of_an_encoder_again_by_its_levels) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {false, false}, {{0, 1}});
  inputs.change(0);         // 1
  inputs.change(1, false);  // 2, unheard
  inputs.change(0, false);  // 3, unheard
  inputs.change(1);         // 4
  wait_for([&] { return edges.taken() == 2; });
  wait_for([&] { return edges.lost() == 1; });
  for (int n = 0; n < 8; ++n) inputs.change(static_cast<std::size_t>(n % 2));
  wait_for([&] { return edges.taken() == 10; });
  const std::int32_t at = edges.count(0);
  for (int n = 0; n < 8; ++n) inputs.change(static_cast<std::size_t>(n % 2));
  wait_for([&] { return edges.count(0) == at + 8; });
  EXPECT_GT(edges.encoder_errors(), 0u);
}

TEST(EdgeThread, says_when_the_chip_is_gone) {
  PlayedInputs inputs;
  EdgeThread edges(inputs, {true}, {});
  EXPECT_FALSE(edges.ended());
  inputs.vanish();
  wait_for([&] { return edges.ended(); });
}

TEST(CycleTimes, take_the_cycles_that_were_woken_soonest_for_the_machines_time) {
  CycleTimes times;
  const image::Nanoseconds start = 5'000 * kMillisecond;
  for (int n = 0; n < 100; ++n)
    times.open(start + n * kMillisecond + (n % 7 + 1) * 10 * kMicrosecond, n * kMillisecond);
  EXPECT_EQ(times.machine(start + 99 * kMillisecond + 10 * kMicrosecond), 99 * kMillisecond);
}

TEST(CycleTimes, follow_a_control_that_has_fallen_behind) {
  CycleTimes times;
  for (int n = 0; n < 200; ++n) times.open(n * kMillisecond + (n < 100 ? 0 : kMillisecond), n * kMillisecond);
  EXPECT_EQ(times.machine(200 * kMillisecond + kMillisecond), 200 * kMillisecond);
}

}  // namespace
}  // namespace servogate::gpio
