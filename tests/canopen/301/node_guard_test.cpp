// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/node_guard.hpp"

#include <gtest/gtest.h>

#include "firmware_if/canopen/301/time_of_day.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::ScriptedBus;
constexpr image::Nanoseconds kMs = image::kMillisecond;

struct NodeGuardTest : ::testing::Test {
  int requests_until(image::Nanoseconds end) {
    int n = 0;
    for (; now < end; now += kMs) n += guard.poll(now, bus);
    return n;
  }
  ScriptedBus bus;
  NodeGuard guard{5, 100 * kMs, 3};
  image::Nanoseconds now = 0;
};

TEST_F(NodeGuardTest, asks_by_remote_request_once_a_guard_time) {
  guard.start(0);
  EXPECT_EQ(requests_until(1000 * kMs), 10);
  EXPECT_EQ(bus.sent.front().id, 0x705u);
  EXPECT_TRUE(bus.sent.front().remote);
  EXPECT_EQ(bus.sent.front().length, 1);
}

TEST_F(NodeGuardTest, answers_with_alternating_toggle_keep_the_node_alive) {
  guard.start(0);
  for (int i = 0; i < 20; ++i) {
    now = i * 100 * kMs;
    EXPECT_EQ(guard.on_answer(frame(0x705, {i % 2 ? 0x85 : 0x05}), now), NodeGuard::Verdict::fine);
  }
  EXPECT_FALSE(guard.lost(now + 300 * kMs));
  EXPECT_TRUE(guard.lost(now + 300 * kMs + 1));
}

TEST_F(NodeGuardTest, an_answer_that_repeats_itself_is_told_and_keeps_nobody_alive) {
  guard.start(0);
  guard.on_answer(frame(0x705, {0x05}), 0);
  EXPECT_EQ(guard.on_answer(frame(0x705, {0x05}), 200 * kMs), NodeGuard::Verdict::wrong_toggle);
  EXPECT_TRUE(guard.lost(301 * kMs));
  EXPECT_EQ(guard.on_answer(frame(0x705, {0x85}), 310 * kMs), NodeGuard::Verdict::fine)
      << "it goes on from what the node said last";
}

TEST_F(NodeGuardTest, a_full_queue_is_asked_again_and_the_rhythm_begins_anew) {
  guard.start(0);
  bus.refuse_sending = true;
  EXPECT_EQ(requests_until(250 * kMs), 0);
  bus.refuse_sending = false;
  EXPECT_EQ(requests_until(450 * kMs), 2);
}

TEST(TimeOfDayFrame, is_little_endian_milliseconds_and_days) {
  const TimeOfDay time{0x01234567, 0x3A98};
  const auto f = time_frame(time);
  EXPECT_EQ(testing::show(f), "100 67 45 23 01 98 3A");
  EXPECT_EQ(parse_time(f), time);
}

TEST(TimeOfDayFrame, of_another_length_or_beyond_midnight_is_none) {
  EXPECT_FALSE(parse_time(frame(0x100, {0, 0, 0, 0, 0})));
  EXPECT_FALSE(parse_time(frame(0x100, {0x00, 0x5C, 0x26, 0x05, 0, 0}))) << "24:00:00.000";
  EXPECT_TRUE(parse_time(frame(0x100, {0xFF, 0x5B, 0x26, 0x05, 0, 0})));
  EXPECT_TRUE(parse_time(frame(0x100, {0xFF, 0x5B, 0x26, 0xF5, 0, 0}))) << "the upper four bits are reserved";
}

TEST(TimeOfDayFrame, goes_over_midnight_into_the_next_day) {
  const TimeOfDay evening{86'399'000, 7};
  EXPECT_EQ(evening.after(999 * kMs), (TimeOfDay{86'399'999, 7}));
  EXPECT_EQ(evening.after(1000 * kMs), (TimeOfDay{0, 8}));
  EXPECT_EQ(evening.after(TimeOfDay::kDay * 2 * kMs), (TimeOfDay{86'399'000, 9}));
}

}  // namespace
}  // namespace servogate::canopen
