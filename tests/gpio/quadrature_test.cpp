// SPDX-License-Identifier: Apache-2.0
// An encoder of two tracks, counted edge by edge.
#include "drivers/gpio/quadrature.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <utility>

namespace servogate::gpio {
namespace {

/// A wheel that turns by quarters of a period, and tells the edge of each.
class Wheel {
 public:
  explicit Wheel(Quadrature& counter) : counter_(counter) {}
  void turn(int quarters) {
    for (; quarters > 0; --quarters) step(+1);
    for (; quarters < 0; ++quarters) step(-1);
  }
  bool a() const { return kA[static_cast<std::size_t>(phase_)]; }
  bool b() const { return kB[static_cast<std::size_t>(phase_)]; }
  /// Turns unheard.
  void slip(int quarters) { phase_ = (phase_ + quarters % 4 + 4) % 4; }

 private:
  static constexpr std::array<bool, 4> kA{false, true, true, false}, kB{false, false, true, true};
  void step(int way) {
    const bool was = b();
    slip(way);
    counter_.edge(b() != was, b() != was ? b() : a());
  }
  Quadrature& counter_;
  int phase_ = 0;
};

TEST(Quadrature, counts_four_for_each_period_up_while_a_leads_and_down_while_b_leads) {
  Quadrature counter;
  Wheel wheel(counter);
  wheel.turn(4);
  EXPECT_EQ(counter.count(), 4);
  wheel.turn(-7);
  EXPECT_EQ(counter.count(), -3);
  EXPECT_EQ(counter.errors(), 0u);
}

TEST(Quadrature, is_where_the_wheel_is_after_any_turning) {
  Quadrature counter;
  Wheel wheel(counter);
  std::mt19937 random(1);
  int at = 0;
  for (int n = 0; n < 10'000; ++n) {
    const int way = static_cast<int>(random() % 41) - 20;
    wheel.turn(way);
    at += way;
    ASSERT_EQ(counter.count(), at);
  }
  EXPECT_EQ(counter.errors(), 0u);
}

TEST(Quadrature, does_not_move_by_a_track_that_chatters) {
  Quadrature counter;
  for (int n = 0; n < 100; ++n) counter.edge(false, n % 2 == 0);
  EXPECT_EQ(counter.count(), 0);
}

TEST(Quadrature, takes_an_edge_to_the_level_it_has_for_an_error_and_stays) {
  Quadrature counter;
  counter.edge(false, true);
  counter.edge(false, true);
  EXPECT_EQ(counter.count(), 1);
  EXPECT_EQ(counter.errors(), 1u);
}

TEST(Quadrature, finds_one_missed_step_by_the_levels_and_takes_two_for_an_error) {
  Quadrature counter;
  Wheel wheel(counter);
  wheel.slip(1);
  counter.settle(wheel.a(), wheel.b());
  EXPECT_EQ(counter.count(), 1);
  EXPECT_EQ(counter.errors(), 0u);
  wheel.slip(2);
  counter.settle(wheel.a(), wheel.b());
  EXPECT_EQ(counter.count(), 1) << "which way round is not known";
  EXPECT_EQ(counter.errors(), 1u);
  wheel.turn(3);
  EXPECT_EQ(counter.count(), 4) << "and it counts on from the levels";
}

TEST(OrderedQuadrature, counts_by_the_times_of_edges_that_overtake_each_other) {
  OrderedQuadrature counter;
  std::mt19937 random(1);
  constexpr std::array<bool, 4> kA{false, true, true, false}, kB{false, false, true, true};
  struct Told {
    image::Nanoseconds t;
    bool track_b, level;
  };
  std::array<Told, 10'000> edges{};
  std::size_t phase = 0;
  int at = 0;
  for (std::size_t n = 0; n < edges.size(); ++n) {
    const int way = n / 1000 % 3 == 2 ? -1 : +1;
    const std::size_t next = (phase + static_cast<std::size_t>(way + 4)) % 4;
    const bool track_b = kB[next] != kB[phase];
    edges[n] = {static_cast<image::Nanoseconds>(n), track_b, track_b ? kB[next] : kA[next]};
    phase = next;
    at += way;
  }
  // Tracks overtake each other; two edges of one track never do.
  for (std::size_t n = 0; n + 1 < edges.size(); n += 2)
    if (random() % 4 == 0 && edges[n].track_b != edges[n + 1].track_b) std::swap(edges[n], edges[n + 1]);
  for (const Told& e : edges) counter.edge(e.track_b, e.level, e.t);
  EXPECT_EQ(counter.count(), at);
  EXPECT_EQ(counter.errors(), 0u);
}

}  // namespace
}  // namespace servogate::gpio
