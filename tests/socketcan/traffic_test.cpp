// SPDX-License-Identifier: Apache-2.0
#include <ctime>

#include "tests/comes.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/socketcan/vcan.hpp"

namespace servogate::socketcan {
namespace {

using image::CanFrame;

CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f;
  f.id = id;
  f.extended = id > 0x7FF;
  for (const std::uint8_t b : bytes) f.data[f.length++] = b;
  return f;
}

image::Nanoseconds monotonic() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * image::kSecond + t.tv_nsec;
}

TEST_F(Vcan, what_is_sent_is_what_candump_shows) {
  auto bus = open();
  const std::string file = ::testing::TempDir() + name_;
  // candump listens once it has shown a mark.
  ASSERT_TRUE(shell("candump -L " + name_ + " > " + file + " & echo $! > " + file + ".pid"));
  const auto shown = [&] { return output_of("cut -d' ' -f3 " + file + " | grep -v '^7FF#'"); };
  ASSERT_TRUE(tests::comes([&] {
    EXPECT_TRUE(shell("cansend " + name_ + " 7FF#"));
    return shell("grep -q '7FF#' " + file);
  }));
  EXPECT_TRUE(bus->send(frame(0x181, {0xDE, 0xAD})));
  EXPECT_TRUE(bus->send(frame(0x18FF1234, {1, 2, 3, 4, 5, 6, 7, 8})));
  CanFrame remote = frame(0x701, {});
  remote.remote = true;
  EXPECT_TRUE(bus->send(remote));
  EXPECT_TRUE(tests::comes([&] { return shown() == "181#DEAD\n18FF1234#0102030405060708\n701#R\n"; }))
      << shown();
  EXPECT_TRUE(shell("kill $(cat " + file + ".pid)"));
}

TEST_F(Vcan, what_cansend_sends_is_received_with_the_kernels_time) {
  auto bus = open();
  const image::Nanoseconds before = monotonic();
  ASSERT_TRUE(shell("cansend " + name_ + " 1A2#11223344 && cansend " + name_ + " 00012345#R"));
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(f.id, 0x1A2u);
  EXPECT_FALSE(f.extended);
  ASSERT_EQ(f.length, 4);
  EXPECT_EQ(f.data[3], 0x44);
  EXPECT_GE(f.timestamp_ns, before - image::kMillisecond);
  EXPECT_LE(f.timestamp_ns, monotonic() + image::kMillisecond);
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(f.id, 0x12345u);
  EXPECT_TRUE(f.extended);
  EXPECT_TRUE(f.remote);
}

TEST_F(Vcan, FD_frames_of_64_bytes_come_and_go) {
  auto bus = open();
  ASSERT_TRUE(shell("cansend " + name_ + " 123##1" + std::string(128, '7')));
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_TRUE(f.fd);
  EXPECT_EQ(f.fd_flags, image::kBitRateSwitch);
  EXPECT_EQ(f.length, 64);
  EXPECT_EQ(f.data[63], 0x77);
  auto other = open();
  EXPECT_TRUE(bus->send(f));
  ASSERT_TRUE(wait_for(*other, f));
  EXPECT_TRUE(f.fd);
  EXPECT_EQ(f.fd_flags, image::kBitRateSwitch);
  EXPECT_EQ(f.length, 64);
}

TEST_F(Vcan, only_what_a_filter_lets_through_is_received) {
  SocketCanConfig config;
  config.filters = {{0x001, 0x07F, false}, {0x700, 0x780, false}};  // node 1, and every heartbeat
  auto bus = open(config);
  for (const char* id : {"182", "00000181", "181", "705", "602"})
    ASSERT_TRUE(shell("cansend " + name_ + " " + id + "#00"));
  CanFrame f;
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(f.id, 0x181u);
  EXPECT_FALSE(f.extended);
  ASSERT_TRUE(wait_for(*bus, f));
  EXPECT_EQ(f.id, 0x705u);
  EXPECT_FALSE(bus->receive(f));
}

TEST_F(Vcan, own_frames_are_not_received) {
  auto bus = open();
  EXPECT_TRUE(bus->send(frame(0x123, {1})));
  CanFrame f;
  EXPECT_FALSE(bus->receive(f));
}

TEST_F(Vcan, a_thousand_frames_arrive_in_their_order) {
  auto bus = open();
  auto other = open();
  CanFrame f;
  for (int i = 0; i < 1000; i += 100) {
    for (int n = i; n < i + 100; ++n)
      ASSERT_TRUE(bus->send(frame(0x200, {static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n >> 8)})));
    for (int n = i; n < i + 100; ++n) {
      ASSERT_TRUE(wait_for(*other, f));
      ASSERT_EQ(f.data[0] | f.data[1] << 8, n);
    }
  }
  EXPECT_EQ(other->lost(), 0u);
}

TEST_F(Vcan, frames_that_nobody_read_in_time_are_counted_as_lost) {
  auto bus = open();
  auto slow = open();
  for (int i = 0; i < 20'000; ++i) ASSERT_TRUE(bus->send(frame(0x200, {1})));
  CanFrame f;
  std::uint64_t read = 0;
  while (slow->receive(f)) ++read;
  ASSERT_LT(read, 20'000u) << "the kernel's buffer held everything";
  ASSERT_TRUE(bus->send(frame(0x201, {1})));
  ASSERT_TRUE(wait_for(*slow, f));
  EXPECT_EQ(read + slow->lost(), 20'000u);
}

TEST_F(Vcan, nothing_is_allocated_while_frames_pass) {
  auto bus = open();
  auto other = open();
  CanFrame f = frame(0x181, {1, 2, 3});
  const std::uint64_t before = counting::allocations();
  for (int i = 0; i < 100; ++i) {
    bus->send(f);
    other->receive(f);
  }
  EXPECT_EQ(counting::allocations(), before);
}

}  // namespace
}  // namespace servogate::socketcan
