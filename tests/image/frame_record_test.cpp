// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/frames/frame_record.hpp"

#include <gtest/gtest.h>

#include "firmware_if/image/alarm.hpp"

namespace servogate::image {
namespace {

TEST(FrameRecord, brings_a_frame_through_an_alarm_record) {
  CanFrame frame;
  frame.id = 0x1FFF'FFFF;
  frame.extended = true;
  frame.length = 8;
  for (std::uint8_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(0xFF - i);
  AlarmRecord record;
  record.detail.put(frame_detail(frame));
  const CanFrame back = frame_of(*record.detail.get<FrameDetail>());
  EXPECT_EQ(back.id, frame.id);
  EXPECT_EQ(back.extended, frame.extended);
  EXPECT_EQ(back.length, frame.length);
  EXPECT_EQ(back.data, frame.data);
  CanFrame remote;
  remote.id = 0x705;
  remote.remote = true;
  EXPECT_TRUE(frame_of(frame_detail(remote)).remote);
  EXPECT_EQ(frame_of(frame_detail(remote)).length, 0);
}

TEST(FrameRecord, of_a_damaged_file_has_eight_bytes_at_most) {
  FrameDetail damaged;
  damaged.length = 255;
  EXPECT_EQ(frame_of(damaged).length, 8);
}

/// Fields of another device than a CAN bus.
struct OtherFields {
  static constexpr DetailKind kDetail = DetailKind::canopen_boot;
  std::uint32_t number = 0;
};

TEST(Detail, gives_its_fields_to_whom_they_belong_only) {
  AlarmRecord record;
  EXPECT_EQ(record.detail.kind(), DetailKind::none);
  EXPECT_FALSE(record.detail.get<OtherFields>().has_value());
  record.detail.put(OtherFields{7});
  EXPECT_EQ(record.detail.get<OtherFields>()->number, 7u);
  EXPECT_FALSE(record.detail.get<FrameDetail>().has_value());
}

}  // namespace
}  // namespace servogate::image
