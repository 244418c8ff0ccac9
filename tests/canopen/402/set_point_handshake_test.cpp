// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/set_point_handshake.hpp"

#include <gtest/gtest.h>

namespace servogate::canopen {
namespace {

constexpr image::Nanoseconds kMs = image::kMillisecond;

TEST(SetPointHandshake, offers_a_target_when_it_stands_and_the_next_one_when_both_bits_have_fallen) {
  SetPointHandshake h;
  h.step(0, 100, false);
  EXPECT_EQ(h.target(), 100);
  EXPECT_FALSE(h.new_set_point()) << "the drive does not have the target yet";
  h.step(kMs, 200, false);
  EXPECT_EQ(h.target(), 100) << "a target on its way is not changed";
  h.step(2 * kMs, 200, true);
  EXPECT_TRUE(h.new_set_point());
  h.on_acknowledge(false);
  h.step(3 * kMs, 300, true);
  EXPECT_TRUE(h.new_set_point());
  EXPECT_EQ(h.target(), 100);
  h.on_acknowledge(true);
  EXPECT_FALSE(h.new_set_point());
  h.step(4 * kMs, 300, true);
  EXPECT_EQ(h.target(), 100) << "bit 12 still stands";
  h.on_acknowledge(false);
  h.step(5 * kMs, 300, true);
  EXPECT_EQ(h.target(), 300);
}

TEST(SetPointHandshake, gives_nothing_where_nothing_is_new) {
  SetPointHandshake h;
  h.step(0, 100, false);
  h.step(kMs, 100, true);
  h.on_acknowledge(true);
  h.on_acknowledge(false);
  for (int i = 0; i < 10; ++i) {
    h.step(i * kMs, 100, true);
    EXPECT_FALSE(h.new_set_point());
  }
}

TEST(SetPointHandshake, asks_again_a_drive_that_did_not_answer) {
  SetPointHandshake h;
  h.step(0, 100, false);
  h.step(kMs, 100, true);
  ASSERT_TRUE(h.new_set_point());
  h.step(kMs + SetPointHandshake::kPatienceNs, 100, true);
  EXPECT_FALSE(h.new_set_point()) << "bit 4 falls, so that it can rise again";
  h.step(2 * kMs + SetPointHandshake::kPatienceNs, 100, true);
  EXPECT_TRUE(h.new_set_point());
}

}  // namespace
}  // namespace servogate::canopen
