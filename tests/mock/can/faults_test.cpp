// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "drivers/mock/can/can_segment.hpp"

namespace servogate::mock {
namespace {

using image::CanState;
using image::kMicrosecond;
using image::kMillisecond;
using image::kSecond;

struct CanFaults : testing::Test {
  CanSegment segment;
  image::CanBus& a = segment.add_endpoint();
  image::CanBus& b = segment.add_endpoint();
  Nanoseconds now = 0;

  void send(std::uint32_t id) {
    CanFrame f;
    f.id = id;
    f.length = 8;
    a.send(f);
  }
  std::vector<CanFrame> after(Nanoseconds duration) {
    segment.advance_to(now += duration);
    std::vector<CanFrame> all;
    CanFrame f;
    while (b.receive(f)) all.push_back(f);
    return all;
  }
};

TEST_F(CanFaults, a_dropped_frame_occupies_the_bus_and_reaches_nobody) {
  ASSERT_TRUE(segment.inject({.kind = fault::Kind::drop, .id = 0x185, .mask = 0x7FF, .count = 1}));
  send(0x185);
  send(0x186);
  send(0x185);
  const auto got = after(kMillisecond);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].id, 0x185u) << "only the first one was hit";
  EXPECT_EQ(segment.statistics().frames, 3u);
}

TEST_F(CanFaults, a_foreign_device_sends_as_many_frames_as_it_is_told_to_so_far_apart) {
  fault::Fault foreign{.kind = fault::Kind::foreign, .delay_ns = 100 * kMillisecond, .id = 0x601, .count = 3};
  ASSERT_TRUE(fault::find_parameter("data")->set("40 18 10", foreign));
  ASSERT_TRUE(segment.inject(foreign));
  const auto got = after(kSecond);
  ASSERT_EQ(got.size(), 3u);
  EXPECT_EQ(got[0].id, 0x601u);
  EXPECT_EQ(got[0].length, 3u);
  EXPECT_EQ(got[0].data[1], 0x18);
  EXPECT_EQ(got[2].timestamp_ns - got[0].timestamp_ns, 200 * kMillisecond);
}

TEST_F(CanFaults, a_foreign_device_of_high_priority_takes_the_whole_wire_until_it_is_cleared) {
  const fault::Fault flood{.kind = fault::Kind::foreign, .id = 1, .count = 0};
  ASSERT_TRUE(segment.inject(flood));
  after(kMillisecond);
  send(0x185);
  for (const CanFrame& frame : after(100 * kMillisecond)) EXPECT_EQ(frame.id, 1u);
  EXPECT_GT(segment.statistics().frames, 1500u) << "frames of 47 bits and their intermission";
  segment.clear(flood);
  const auto got = after(kMillisecond);
  ASSERT_FALSE(got.empty());
  EXPECT_EQ(got.back().id, 0x185u);
  const auto sent = segment.statistics().frames;
  after(kMillisecond);
  EXPECT_EQ(segment.statistics().frames, sent);
}

TEST_F(CanFaults, that_do_not_happen_to_a_wire_are_refused) {
  EXPECT_FALSE(segment.inject({.kind = fault::Kind::over_current}));
  EXPECT_FALSE(segment.inject({.kind = fault::Kind::silent}));
}

TEST_F(CanFaults, skip_lets_frames_pass_before_the_fault) {
  segment.inject({.kind = fault::Kind::drop, .skip = 2, .count = 1});
  for (const std::uint32_t id : {1u, 2u, 3u, 4u}) send(id);
  const auto got = after(kMillisecond);
  ASSERT_EQ(got.size(), 3u);
  EXPECT_EQ(got[2].id, 4u);
}

TEST_F(CanFaults, a_delayed_frame_lets_others_pass) {
  segment.inject({.kind = fault::Kind::delay, .delay_ns = 500 * kMicrosecond, .id = 1, .mask = 0x7FF});
  send(1);
  send(2);
  const auto got = after(2 * kMillisecond);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].id, 2u);
  EXPECT_GE(got[1].timestamp_ns, 500 * kMicrosecond);
}

TEST_F(CanFaults, a_duplicated_frame_is_received_twice) {
  segment.inject({.kind = fault::Kind::repeat});
  send(1);
  EXPECT_EQ(after(kMillisecond).size(), 2u);
}

TEST_F(CanFaults, a_corrupted_frame_is_repeated_after_an_error_frame_and_arrives_once) {
  CanFrame f;
  f.id = 1;
  f.length = 8;
  const Nanoseconds clean = frame_bits(f) * kMicrosecond;
  segment.inject({.kind = fault::Kind::corrupt});
  send(1);
  const auto got = after(kMillisecond);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].timestamp_ns, clean + (frame_bits(f) * 3 / 4 + 20 + 3) * kMicrosecond);
  EXPECT_EQ(segment.statistics().errors, 1u);
  EXPECT_EQ(a.state(), CanState::error_active);
}

TEST_F(CanFaults, a_wire_that_always_breaks_frames_takes_the_sender_off_the_bus) {
  segment.inject({.kind = fault::Kind::corrupt, .count = 0});
  send(1);
  // Twelve errors: 96 = warning; 16: 128 = passive; 32: 256 = off.
  bool warned = false, passive = false;
  for (int i = 0; i < 100 && a.state() != CanState::bus_off; ++i) {
    after(50 * kMicrosecond);
    warned |= a.state() == CanState::error_warning;
    passive |= a.state() == CanState::error_passive;
  }
  EXPECT_TRUE(warned);
  EXPECT_TRUE(passive);
  EXPECT_EQ(a.state(), CanState::bus_off);
  EXPECT_EQ(segment.statistics().errors, 32u);
  EXPECT_TRUE(b.state() == CanState::error_active) << "a receiver counts one where the sender counts eight";
  CanFrame f;
  EXPECT_FALSE(a.send(f));
}

TEST_F(CanFaults, a_bus_off_endpoint_returns_after_128_times_11_recessive_bits) {
  const int number = segment.number_of(a);
  segment.force_bus_off(number);
  after(kMillisecond);
  EXPECT_EQ(a.state(), CanState::bus_off);
  segment.restart(number);
  after(1407 * kMicrosecond);
  EXPECT_EQ(a.state(), CanState::bus_off);
  after(kMicrosecond);
  EXPECT_EQ(a.state(), CanState::error_active);
  send(7);
  EXPECT_EQ(after(kMillisecond).size(), 1u);
}

TEST_F(CanFaults, an_interface_that_goes_down_throws_away_what_waits_and_takes_nothing_until_it_is_up) {
  send(6);
  segment.set_connected(segment.number_of(a), false);
  send(7);
  EXPECT_TRUE(after(kMillisecond).empty());
  EXPECT_EQ(a.state(), CanState::down);
  segment.set_connected(segment.number_of(a), true);
  EXPECT_TRUE(after(kMillisecond).empty()) << "nothing old goes out later";
  send(8);
  EXPECT_EQ(after(kMillisecond).size(), 1u);
}

TEST_F(CanFaults, two_senders_of_one_identifier_with_different_data_break_each_others_frames) {
  CanFrame f;
  f.id = 0x181;
  f.length = 1;
  a.send(f);
  f.data[0] = 1;
  b.send(f);
  auto& ear = segment.add_endpoint();
  segment.advance_to(20 * kMillisecond);
  EXPECT_EQ(a.state(), CanState::bus_off);
  EXPECT_EQ(b.state(), CanState::bus_off);
  EXPECT_FALSE(ear.receive(f));
}

TEST_F(CanFaults, two_senders_of_the_same_frame_pass_as_one) {
  CanFrame f;
  f.id = 0x181;
  a.send(f);
  b.send(f);
  auto& ear = segment.add_endpoint();
  segment.advance_to(kMillisecond);
  EXPECT_TRUE(ear.receive(f));
  EXPECT_FALSE(ear.receive(f));
}

TEST_F(CanFaults, at_most_sixteen_faults_wait_at_a_time_and_used_ones_make_room) {
  for (int i = 0; i < 16; ++i)
    EXPECT_TRUE(segment.inject({.kind = fault::Kind::drop, .id = 5, .mask = 0x7FF}));
  EXPECT_FALSE(segment.inject({.kind = fault::Kind::drop}));
  send(5);
  after(kMillisecond);
  EXPECT_TRUE(segment.inject({.kind = fault::Kind::drop}));
  segment.clear_faults();
  send(5);
  EXPECT_EQ(after(kMillisecond).size(), 1u);
}

}  // namespace
}  // namespace servogate::mock
