// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "firmware_if/board/protocol/bytes.hpp"
#include "tests/property_seed.hpp"

namespace servogate::board {
namespace {

using Buffer = std::array<std::uint8_t, kMostBytes>;

template <class Body>
Body through(const Body& body, Kind kind = Kind::cycle) {
  Buffer buffer{};
  const std::size_t size = put({kind, 77}, body, buffer);
  Message m;
  EXPECT_TRUE(parse({buffer.data(), size}, m));
  EXPECT_EQ(m.header.sequence, 77u);
  Body back;
  EXPECT_TRUE(take(m.body, back));
  return back;
}

TEST(BoardMessages, a_command_stands_in_its_bytes_as_the_document_says) {
  Command c;
  c.outputs = 0x04030201;
  c.enable = 5;
  c.latch = 6;
  c.flags = kResetTrip;
  c.analog = {-2, 0, 0, 256};
  c.channels[1] = {-1, 1000};
  Buffer buffer{};
  const std::size_t size = put({Kind::cycle, 0x0A0B0C0D}, c, buffer);
  ASSERT_EQ(size, 8u + 7 + 8 + 32);
  const std::vector<std::uint8_t> first(buffer.begin(), buffer.begin() + 23);
  EXPECT_EQ(first, (std::vector<std::uint8_t>{0x53, 0x03, 55, 0,    0x0D, 0x0C, 0x0B, 0x0A, 1, 2, 3, 4,
                                              5,    6,    1,  0xFE, 0xFF, 0,    0,    0,    0, 0, 1}));
  const std::vector<std::uint8_t> second(buffer.begin() + 31, buffer.begin() + 39);
  EXPECT_EQ(second, (std::vector<std::uint8_t>{0xFF, 0xFF, 0xFF, 0xFF, 0xE8, 0x03, 0, 0}));
}

TEST(BoardMessages, each_comes_back_as_it_went) {
  Description d;
  d.serial = {'A', '1'};
  d.capabilities = {1, 2, 0, 0x3E};
  d.max_step_rate = 4'000'000'000u;
  EXPECT_EQ(through(d).max_step_rate, d.max_step_rate);
  EXPECT_EQ(through(d).serial, d.serial);
  EXPECT_EQ(through(d).capabilities, d.capabilities);
  Configuration c;
  c.channels[3] = {Output::pwm, true, 9, 123456, 777};
  c.safe_analog[2] = -32767;
  EXPECT_EQ(through(c).channels[3].output, Output::pwm);
  EXPECT_TRUE(through(c).channels[3].fault_is_low);
  EXPECT_EQ(through(c).channels[3].stop_rate, 123456u);
  EXPECT_EQ(through(c).safe_analog[2], -32767);
  Status s;
  s.channels[2] = {-5, 7, -9, 200};
  s.edge_count = 2;
  s.edges[1] = {31, true, 0xFFFFFFFF};
  EXPECT_EQ(through(s).channels[2].latched, -9);
  EXPECT_EQ(through(s).edges[1].t_us, 0xFFFFFFFF);
  EXPECT_TRUE(through(s).edges[1].level);
}

TEST(BoardMessages, whose_length_is_a_whole_number_of_packets_ends_with_a_short_one) {
  for (std::uint8_t edges = 0; edges <= kEdges; ++edges) {
    Status s;
    s.edge_count = edges;
    Buffer buffer{};
    const std::size_t size = put({Kind::status, 1}, s, buffer);
    EXPECT_NE(size % 64, 0u);
    Message m;
    EXPECT_TRUE(parse({buffer.data(), size}, m));
  }
  // A description of 56 bytes behind its header would fill a packet: no body of this layout does, so one is
  // made.
  Buffer buffer{};
  buffer[0] = kMark;
  buffer[2] = 64;
  Message m;
  EXPECT_FALSE(parse({buffer.data(), 64}, m));
  EXPECT_TRUE(parse({buffer.data(), 65}, m));
  EXPECT_EQ(m.body.size(), 56u);
}

TEST(BoardMessages, that_are_none_are_not_taken) {
  std::mt19937_64 random(test::property_seed());
  Command command;
  Buffer buffer{};
  const std::size_t size = put({Kind::cycle, 1}, command, buffer);
  for (std::size_t cut = 0; cut < size; ++cut) {
    Message m;
    EXPECT_FALSE(parse({buffer.data(), cut}, m));
  }
  for (int n = 0; n < 20'000; ++n) {
    std::vector<std::uint8_t> bytes(random() % 200);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    if (!bytes.empty()) bytes[0] = kMark;
    if (bytes.size() > 3 && random() % 2 == 0) {
      bytes[2] = static_cast<std::uint8_t>(bytes.size());
      bytes[3] = 0;
    }
    Message m;
    if (!parse(bytes, m)) continue;
    Status s;
    if (take(m.body, s)) {
      EXPECT_LE(s.edge_count, kEdges);
    }
    Configuration c;
    if (take(m.body, c)) {
      for (const ChannelSetting& channel : c.channels) EXPECT_LE(channel.output, Output::pwm);
    }
    Injection i;
    if (take(m.body, i)) {
      EXPECT_LE(i.fault, Fault::drive_fault);
    }
  }
}

}  // namespace
}  // namespace servogate::board
