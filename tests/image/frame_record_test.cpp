// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/frame_record.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace servogate::image {
namespace {

TEST(FrameRecord, brings_a_frame_through_an_alarm_record) {
  CanFrame frame;
  frame.id = 0x1FFF'FFFF;
  frame.extended = true;
  frame.length = 8;
  for (std::uint8_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(0xFF - i);
  AlarmRecord record;
  pack_frame(frame, record);
  const CanFrame back = unpack_frame(record);
  EXPECT_EQ(back.id, frame.id);
  EXPECT_EQ(back.extended, frame.extended);
  EXPECT_EQ(back.length, frame.length);
  EXPECT_EQ(back.data, frame.data);
  CanFrame remote;
  remote.id = 0x705;
  remote.remote = true;
  pack_frame(remote, record);
  EXPECT_TRUE(unpack_frame(record).remote);
  EXPECT_EQ(unpack_frame(record).length, 0);
}

TEST(FrameRecord, with_nothing_but_an_identifier_is_a_frame_without_bytes) {
  AlarmRecord record;
  record.value = 0x205;
  EXPECT_EQ(unpack_frame(record).id, 0x205u);
  EXPECT_EQ(unpack_frame(record).length, 0);
  for (const double odd : {-1.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    record.value = record.limit = record.detail1 = record.detail2 = odd;
    EXPECT_LE(unpack_frame(record).length, 8);
  }
}

}  // namespace
}  // namespace servogate::image
