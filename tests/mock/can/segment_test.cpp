// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

using image::kMicrosecond;
using image::kMillisecond;

CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> bytes = {}) {
  CanFrame f;
  f.id = id;
  f.length = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) f.data[i] = bytes[i];
  return f;
}

std::vector<CanFrame> drain(image::CanBus& bus) {
  std::vector<CanFrame> all;
  CanFrame f;
  while (bus.receive(f)) all.push_back(f);
  return all;
}

TEST(CanSegment, a_frame_arrives_at_its_last_bit_and_not_a_nanosecond_before) {
  CanSegment segment({.bit_rate = 500'000});
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  const CanFrame f = frame(0x123, {1, 2, 3});
  const Nanoseconds duration = frame_bits(f) * 2 * kMicrosecond;
  ASSERT_TRUE(a.send(f));
  segment.advance_to(duration - 1);
  CanFrame got;
  EXPECT_FALSE(b.receive(got));
  segment.advance_to(duration);
  ASSERT_TRUE(b.receive(got));
  EXPECT_EQ(got.id, 0x123u);
  EXPECT_EQ(got.timestamp_ns, duration);
  EXPECT_FALSE(a.receive(got)) << "own frames are not received";
}

TEST(CanSegment, frames_follow_each_other_after_three_bits_of_rest) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  a.send(frame(1));
  a.send(frame(2));
  segment.advance_to(kMillisecond);
  const auto got = drain(b);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[1].timestamp_ns - got[0].timestamp_ns, (3 + frame_bits(frame(2))) * kMicrosecond);
}

TEST(CanSegment, the_lowest_identifier_wins_whoever_asked_first) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  auto& ear = segment.add_endpoint();
  a.send(frame(0x205));
  a.send(frame(0x080));
  b.send(frame(0x181));
  b.send(frame(0x000, {1, 0}));
  segment.advance_to(kMillisecond);
  std::vector<std::uint32_t> order;
  for (const auto& f : drain(ear)) order.push_back(f.id);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x000, 0x080, 0x181, 0x205}));
}

TEST(CanSegment, data_beats_remote_and_base_beats_extended_of_the_same_leading_bits) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  auto& c = segment.add_endpoint();
  auto& ear = segment.add_endpoint();
  CanFrame extended = frame(0x100u << 18), remote = frame(0x100), data = frame(0x100);
  extended.extended = true;
  remote.remote = true;
  a.send(extended);
  b.send(remote);
  c.send(data);
  segment.advance_to(kMillisecond);
  const auto got = drain(ear);
  ASSERT_EQ(got.size(), 3u);
  EXPECT_FALSE(got[0].remote || got[0].extended);
  EXPECT_TRUE(got[1].remote);
  EXPECT_TRUE(got[2].extended);
}

TEST(CanSegment, a_frame_on_the_wire_is_not_interrupted_by_a_better_one) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  auto& ear = segment.add_endpoint();
  a.send(frame(0x700, {0}));
  segment.advance_to(10 * kMicrosecond);
  b.send(frame(0x000, {1, 0}));
  segment.advance_to(kMillisecond);
  const auto got = drain(ear);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].id, 0x700u);
}

TEST(CanSegment, in_order_mailboxes_let_a_low_priority_frame_block_its_own_queue) {
  CanSegment segment({.priority_mailboxes = false});
  auto& a = segment.add_endpoint();
  auto& ear = segment.add_endpoint();
  a.send(frame(0x700));
  a.send(frame(0x080));
  segment.advance_to(kMillisecond);
  EXPECT_EQ(drain(ear).front().id, 0x700u);
}

TEST(CanSegment, whoever_sends_at_the_very_time_of_the_call_takes_part_in_the_arbitration) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  auto& ear = segment.add_endpoint();
  a.send(frame(0x700));
  segment.advance_to(0);
  b.send(frame(0x080));
  segment.advance_to(kMillisecond);
  EXPECT_EQ(drain(ear).front().id, 0x080u);
}

TEST(CanSegment, queues_are_bounded_and_losses_counted) {
  CanSegment segment({.send_queue = 4, .receive_queue = 3});
  auto& a = segment.add_endpoint();
  auto& b = segment.add_endpoint();
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_TRUE(a.send(frame(i)));
  EXPECT_FALSE(a.send(frame(9)));
  segment.advance_to(kMillisecond);
  EXPECT_EQ(drain(b).size(), 3u);
  EXPECT_EQ(segment.statistics().lost, 1u);
  EXPECT_EQ(segment.statistics().refused, 1u);
}

TEST(CanSegment, fd_frames_and_frames_of_more_than_eight_bytes_are_refused) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  CanFrame f = frame(1);
  f.fd = true;
  EXPECT_FALSE(a.send(f));
  f.fd = false;
  f.length = 9;
  EXPECT_FALSE(a.send(f));
}

TEST(CanSegment, load_is_the_share_of_bits_on_the_wire) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  segment.add_endpoint();
  const CanFrame f = frame(0x185, {0x37, 0x12, 1, 2, 3, 4});
  for (int i = 1; i <= 2000; ++i) {
    a.send(f);
    segment.advance_to(i * kMillisecond);
  }
  EXPECT_NEAR(segment.load(), (frame_bits(f) + 3) / 1000.0, 1e-3);
  EXPECT_EQ(segment.statistics().frames, 2000u);
  EXPECT_EQ(segment.statistics().bits, 2000u * (frame_bits(f) + 3));
}

TEST(CanSegment, alone_on_the_bus_a_frame_is_never_acknowledged_and_the_sender_turns_error_passive) {
  CanSegment segment;
  auto& a = segment.add_endpoint();
  a.send(frame(1));
  segment.advance_to(50 * kMillisecond);
  EXPECT_EQ(a.state(), image::CanState::error_passive);
  EXPECT_EQ(segment.statistics().frames, 0u);
  auto& b = segment.add_endpoint();
  segment.advance_to(51 * kMillisecond);
  EXPECT_EQ(drain(b).size(), 1u) << "it is still pending and passes as soon as somebody listens";
}

struct Wire final : CanMonitor {
  struct Row {
    CanFrame frame;
    int sender;
    Nanoseconds start, end;
    Outcome outcome;
  };
  std::vector<Row> rows;
  void on_wire(const CanFrame& f, int sender, Nanoseconds start, Nanoseconds end,
               Outcome outcome) noexcept override {
    rows.push_back({f, sender, start, end, outcome});
  }
};

TEST(CanSegment, random_traffic_never_overlaps_never_inverts_priority_and_loses_nothing) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 40; ++round) {
    const std::uint32_t rates[] = {125'000, 250'000, 500'000, 800'000, 1'000'000};
    CanSegment segment({.bit_rate = rates[random() % 5], .send_queue = 400, .receive_queue = 4000});
    Wire wire;
    segment.set_monitor(&wire);
    std::vector<image::CanBus*> ends;
    for (int i = 0; i < 5; ++i) ends.push_back(&segment.add_endpoint());
    std::vector<std::vector<Nanoseconds>> queued(0x800);  // per identifier, in order
    Nanoseconds t = 0;
    std::size_t sent = 0;
    for (int i = 0; i < 300; ++i) {
      // Each endpoint owns every fifth identifier, as on a real bus.
      const std::size_t who = random() % 5;
      const std::uint32_t id = (random() % 400) * 5 + static_cast<std::uint32_t>(who);
      ASSERT_TRUE(
          ends[who]->send(frame(id, {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)})));
      queued[id].push_back(t);
      ++sent;
      t += static_cast<Nanoseconds>(random() % 400) * kMicrosecond;
      segment.advance_to(t);
    }
    segment.advance_to(t + image::kSecond);
    ASSERT_EQ(wire.rows.size(), sent);
    std::vector<std::size_t> used(0x800, 0);
    for (std::size_t i = 0; i < wire.rows.size(); ++i) {
      const auto& row = wire.rows[i];
      ASSERT_EQ(row.end - row.start, segment.bit_time(frame_bits(row.frame)));
      if (i > 0) {
        ASSERT_GE(row.start, wire.rows[i - 1].end + segment.bit_time(3));
      }
      const Nanoseconds own = queued[row.frame.id][used[row.frame.id]++];
      ASSERT_LE(own, row.start);
      for (std::size_t id = 0; id < row.frame.id; ++id)
        ASSERT_FALSE(used[id] < queued[id].size() && queued[id][used[id]] < row.start)
            << "a better frame " << id << " was waiting when " << row.frame.id << " began";
    }
    for (std::size_t e = 0; e < 5; ++e) {
      std::size_t own = 0;
      for (const auto& row : wire.rows) own += row.sender == static_cast<int>(e);
      ASSERT_EQ(drain(*ends[e]).size(), sent - own);
    }
  }
}

}  // namespace
}  // namespace servogate::mock
