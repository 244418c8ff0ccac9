// SPDX-License-Identifier: Apache-2.0
// Edges of the kernel's simulated chip: their times, bounce, bursts, an encoder. What depends on how fast the
// computer is gets printed, never judged.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <iostream>
#include <thread>

#include "drivers/clock.hpp"
#include "tests/gpio/simulated_chip.hpp"

namespace servogate::gpio {
namespace {

using image::Edge;
using image::kMillisecond;
using image::Nanoseconds;

constexpr unsigned kSwitch = 20, kTrackA = 21, kTrackB = 22;

class EdgesOfTheKernel : public ChipOfTheKernel {
 protected:
  static Line on_edges(const char* name, unsigned offset, const image::PointRule& r) {
    Line line{name, offset, r};
    line.edges = true;
    return line;
  }
  static Nanoseconds now() { return drivers::clock_ns(CLOCK_MONOTONIC); }
  /// A cycle whose time is that of the computer.
  void real_cycle(GpioChip& chip) {
    image_->now.t_ns = now();
    image_->edges.clear();
    chip.open_cycle(*image_);
    chip.receive(*image_, notices_);
    chip.send(*image_);
    for (const Edge& e : image_->edges.list()) seen_.push_back(e);
  }
  /// Cycles until the condition holds, however long that takes.
  template <typename Condition>
  void cycles_until(GpioChip& chip, Condition&& condition) {
    while (!condition()) real_cycle(chip);
  }
  std::uint64_t known(const GpioChip& chip) const {
    const ChipCounters c = chip.counters();
    return c.edges + c.lost;
  }

  std::vector<Edge> seen_;
};

TEST_F(EdgesOfTheKernel, have_the_time_of_the_interrupt_whenever_the_cycle_comes_to_them) {
  pull(kSwitch, false);
  const auto chip = open({on_edges("home", kSwitch, rule("SA6", true))});
  ASSERT_NE(chip, nullptr) << why_.str();
  real_cycle(*chip);
  const Nanoseconds before = now();
  pull(kSwitch, true);
  const Nanoseconds after = now();
  cycles_until(*chip, [&] { return !seen_.empty(); });
  EXPECT_TRUE(bit("SA6"));
  EXPECT_EQ(seen_[0].place, *image::parse_place("SA6"));
  EXPECT_TRUE(seen_[0].level);
  // The machine's time is the computer's here, less what the soonest of the cycles was woken late.
  EXPECT_GE(seen_[0].t_ns, before - kMillisecond);
  std::cout << "edge " << (seen_[0].t_ns - before) / 1000 << " us after the wire was told, "
            << (after - before) / 1000 << " us\n";
}

TEST_F(EdgesOfTheKernel, are_told_as_the_point_has_them_of_an_inverted_line_and_not_debounced) {
  pull(kSwitch, true);
  image::PointRule closed = rule("SA6", true, true);
  closed.debounce_ns = 20 * kMillisecond;
  const auto chip = open({on_edges("limit", kSwitch, closed)});
  ASSERT_NE(chip, nullptr) << why_.str();
  real_cycle(*chip);
  pull(kSwitch, false);
  cycles_until(*chip, [&] { return !seen_.empty(); });
  EXPECT_TRUE(seen_[0].level);
  const Nanoseconds edge = seen_[0].t_ns;
  cycles_until(*chip, [&] { return bit("SA6"); });
  EXPECT_GE(image_->now.t_ns - edge, 20 * kMillisecond) << "the point is";
}

TEST_F(EdgesOfTheKernel, of_a_bouncing_switch_are_all_told_and_its_point_changes_once) {
  pull(kSwitch, false);
  image::PointRule bouncing = rule("SA6", true);
  bouncing.debounce_ns = 2 * image::kSecond;
  const auto chip = open({on_edges("home", kSwitch, bouncing)});
  ASSERT_NE(chip, nullptr) << why_.str();
  real_cycle(*chip);
  constexpr std::uint64_t kFlips = 25;
  bool changed_while_bouncing = false;
  for (std::uint64_t n = 0; n < kFlips; ++n) {
    pull(kSwitch, n % 2 == 0);
    cycles_until(*chip, [&] { return known(*chip) > n; });
    const bool stalled = !seen_.empty() && image_->now.t_ns - seen_.back().t_ns > image::kSecond;
    changed_while_bouncing = changed_while_bouncing || (bit("SA6") && !stalled && n + 1 < kFlips);
  }
  EXPECT_FALSE(changed_while_bouncing);
  cycles_until(*chip, [&] { return bit("SA6"); });
  EXPECT_EQ(seen_.size() + chip->counters().lost, kFlips);
  EXPECT_TRUE(seen_.back().level);
}

TEST_F(EdgesOfTheKernel, of_a_burst_of_10000_are_told_or_counted_as_lost) {
  constexpr int kBurst = 10'000;
  pull(kSwitch, false);
  const auto chip = open({on_edges("noisy", kSwitch, rule("SA6", true))});
  ASSERT_NE(chip, nullptr) << why_.str();
  real_cycle(*chip);
  const Nanoseconds begin = now();
  Nanoseconds took = 0;
  {
    const Wire wire(sysfs_, kSwitch);
    std::atomic<bool> over{false};
    std::jthread world([&] {
      for (int n = 0; n < kBurst; ++n) wire.pull(n % 2 == 0);
      took = now() - begin;
      over = true;
    });
    // A slow computer merges edges: how many there are to be known nobody can say before.
    while (!over) real_cycle(*chip);
    world.join();
  }
  // One more edge behind the burst: what was lost before it is known by it.
  pull(kSwitch, true);
  cycles_until(*chip, [&] {
    return bit("SA6") && !seen_.empty() && seen_.back().level && image_->edges.list().empty();
  });
  const ChipCounters c = chip->counters();
  std::cout << kBurst + 1 << " edges in " << took / kMillisecond << " ms: the kernel gave " << c.edges
            << ", the cycle saw " << seen_.size() << ", counted as lost " << c.lost << " and "
            << image_->edges.lost() << "\n";
  EXPECT_EQ(bit("SA6"), level(kSwitch));
  EXPECT_LE(c.edges, std::uint64_t{kBurst + 1});
  EXPECT_GE(seen_.size() + image_->edges.lost(), c.edges) << "what the kernel gave is seen or counted";
  for (std::size_t n = 1; n < seen_.size(); ++n) ASSERT_GE(seen_[n].t_ns, seen_[n - 1].t_ns) << n;
  // A later edge is told as before.
  seen_.clear();
  pull(kSwitch, false);
  cycles_until(*chip, [&] { return !seen_.empty(); });
  EXPECT_FALSE(seen_.back().level);
}

/// Turns an encoder on two wires by quarters of its period.
class Hand {
 public:
  explicit Hand(const std::string& sysfs) : a_(sysfs, kTrackA), b_(sysfs, kTrackB) {}
  void turn(int way) {
    phase_ = (phase_ + way + 4) % 4;
    if (phase_ % 2 == (way > 0 ? 1 : 0))
      a_.pull(phase_ == 1 || phase_ == 2);
    else
      b_.pull(phase_ == 2 || phase_ == 3);
  }

 private:
  Wire a_, b_;
  int phase_ = 0;
};

TEST_F(EdgesOfTheKernel, of_two_lines_are_the_counts_of_a_handwheel) {
  pull(kTrackA, false);
  pull(kTrackB, false);
  Line wheel{"wheel", kTrackA, counts("SA40.LI")};
  wheel.b_offset = kTrackB;
  const auto chip = open({wheel, {"limit", kSwitch, rule("SA6", true)}});
  ASSERT_NE(chip, nullptr) << why_.str();
  real_cycle(*chip);
  EXPECT_EQ(number("SA40.LI"), 0.0);
  Hand hand(sysfs_);
  int at = 0;
  for (const int way : {+1, -1, +1}) {
    for (int n = 0; n < 100; ++n) {
      hand.turn(way);
      at += way;
      cycles_until(*chip, [&] { return number("SA40.LI") == at; });
    }
  }
  EXPECT_EQ(chip->counters().encoder_errors, 0u);
  EXPECT_EQ(chip->counters().lost, 0u);
  EXPECT_TRUE(seen_.empty()) << "its edges are no edges of a point";
  EXPECT_EQ(image_->sources[0].quality, image::Quality::good);
}

TEST_F(EdgesOfTheKernel, are_counted_at_the_rate_that_this_computer_can_follow) {
  pull(kTrackA, false);
  pull(kTrackB, false);
  Line wheel{"wheel", kTrackA, counts("SA40.LI")};
  wheel.b_offset = kTrackB;
  const auto chip = open({wheel});
  ASSERT_NE(chip, nullptr) << why_.str();
  real_cycle(*chip);
  Hand hand(sysfs_);
  constexpr int kEdges = 1000;
  double followed = 0.0;
  for (const int rate : {100, 200, 500, 1'000, 2'000, 5'000, 10'000, 20'000, 50'000, 0}) {
    const ChipCounters before = chip->counters();
    const auto from = static_cast<int>(number("SA40.LI"));
    const Nanoseconds begin = now();
    Nanoseconds end = 0;
    const int edges = rate == 0 || rate >= 1'000 ? kEdges : rate;
    std::jthread world([&] {
      for (int n = 0; n < edges; ++n) {
        while (rate != 0 && now() < begin + n * image::kSecond / rate) std::this_thread::yield();
        hand.turn(+1);
      }
      end = now();
    });
    world.join();
    // A step back and forth: what was lost is known by it, and where the wheel stands.
    hand.turn(-1);
    cycles_until(*chip, [&] { return known(*chip) > before.edges + before.lost; });
    hand.turn(+1);
    int at = -1;
    for (int still = 0; still < 2'000; ++still) {
      real_cycle(*chip);
      if (static_cast<int>(number("SA40.LI")) != at) still = 0;
      at = static_cast<int>(number("SA40.LI"));
    }
    const ChipCounters after = chip->counters();
    const bool clean = after.lost == before.lost && after.encoder_errors == before.encoder_errors;
    const double real_rate = edges * 1e9 / static_cast<double>(end - begin);
    std::cout << "asked " << rate << " edges/s, made " << static_cast<int>(real_rate) << ": " << at - from
              << " of " << edges << " counted, lost " << after.lost - before.lost << ", errors "
              << after.encoder_errors - before.encoder_errors << "\n";
    if (clean && at - from == edges) followed = std::max(followed, real_rate);
    EXPECT_TRUE(at - from == edges || !clean) << "a count is missing that nobody has noticed";
  }
  std::cout << "a handwheel is followed at " << static_cast<int>(followed) << " edges/s\n";
}

}  // namespace
}  // namespace servogate::gpio
