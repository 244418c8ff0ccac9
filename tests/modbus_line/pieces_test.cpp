// SPDX-License-Identifier: Apache-2.0
// What a line is made of, and its end in the cycle.
#include <gtest/gtest.h>

#include <thread>

#include "tests/counting/allocations.hpp"
#include "tests/modbus_line/rig/cycles.hpp"

namespace servogate::modbus_line {
namespace {

TEST(Latest, gives_the_newest_value_once_and_never_a_mixed_one) {
  struct Pair {
    std::int64_t a = 0, b = 0;
  };
  drivers::Latest<Pair> latest;
  EXPECT_EQ(latest.take(), nullptr);
  latest.put({1, -1});
  latest.put({2, -2});
  const Pair* taken = latest.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(taken->a, 2);
  EXPECT_EQ(latest.take(), nullptr);
  constexpr std::int64_t kMany = 300'000;
  std::thread writer([&] {
    for (std::int64_t n = 3; n <= kMany; ++n) latest.put({n, -n});
  });
  std::int64_t last = 2;
  while (last < kMany) {
    const Pair* p = latest.take();
    if (p == nullptr) continue;
    ASSERT_EQ(p->a, -p->b);
    ASSERT_GT(p->a, last);
    last = p->a;
  }
  writer.join();
}

TEST(ModbusTcpPeer, is_a_host_and_a_port) {
  const auto peer = modbus::parse_tcp("10.0.0.5:502");
  ASSERT_TRUE(peer.has_value());
  EXPECT_EQ(peer->host, "10.0.0.5");
  EXPECT_EQ(peer->port, "502");
  EXPECT_EQ(modbus::parse_tcp("[::1]:502")->host, "::1");
  EXPECT_EQ(modbus::parse_tcp("cabinet.local:1502")->host, "cabinet.local");
  for (const char* wrong :
       {"", ":502", "host", "host:", "host:0", "host:65536", "host:5x", "::1:502", "a b:502"})
    EXPECT_FALSE(modbus::parse_tcp(wrong).has_value()) << wrong;
}

TEST(ModbusLine, receives_and_sends_without_allocating) {
  Units units(Units::Wire::tcp);
  Cycles cycles(tcp(units), {1});
  ASSERT_TRUE(cycles.until([&] { return cycles.good(0); }));
  std::uint64_t inside = 0;
  image::Notices notices;
  for (int n = 0; n < 500; ++n) {
    cycles.set_coil(0, 0, n % 7 == 0);
    image::CycleTime& now = cycles.image().now;
    now = {now.number + 1, (now.number + 1) * image::kMillisecond, image::kMillisecond};
    {
      const counting::Tally tally(inside);
      cycles.line().receive(cycles.image(), notices);
      cycles.line().send(cycles.image());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(inside, 0u);
  EXPECT_GT(counting::allocations(), 0u) << "the counter itself works";
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().requests > 10; }));
}

}  // namespace
}  // namespace servogate::modbus_line
