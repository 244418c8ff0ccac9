// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/touch_probe.hpp"

#include <gtest/gtest.h>

namespace servogate::canopen {
namespace {

using image::LatchSource;

/// Brings a probe to "armed" as a drive would let it.
TouchProbe armed(LatchSource source, bool negative = false) {
  TouchProbe probe;
  probe.command(true, source, negative);
  probe.on_status(0);
  probe.on_status(source == LatchSource::probe_2 ? 0x0100 : 0x0001);
  return probe;
}

TEST(TouchProbe, asks_for_the_zero_mark_by_the_bits_of_60B8h) {
  TouchProbe probe;
  EXPECT_EQ(probe.function(), 0);
  EXPECT_FALSE(probe.wants_status());
  probe.command(true, LatchSource::zero_mark, false);
  EXPECT_EQ(probe.function(), 0) << "first the old function is switched off";
  EXPECT_TRUE(probe.wants_status());
  probe.on_status(0x0000);
  EXPECT_EQ(probe.function(), 0x0015) << "enable, zero impulse, positive edge, first event only";
}

TEST(TouchProbe, asks_for_probe_inputs_and_edges) {
  EXPECT_EQ(armed(LatchSource::probe_1).function(), 0x0011);
  EXPECT_EQ(armed(LatchSource::probe_1, true).function(), 0x0021);
  EXPECT_EQ(armed(LatchSource::probe_2).function(), 0x1100);
  EXPECT_EQ(armed(LatchSource::probe_2, true).function(), 0x2100);
  EXPECT_EQ(armed(LatchSource::probe_1).value_object(), 0x60BA);
  EXPECT_EQ(armed(LatchSource::probe_1, true).value_object(), 0x60BB);
  EXPECT_EQ(armed(LatchSource::probe_2).value_object(), 0x60BC);
  EXPECT_EQ(armed(LatchSource::probe_2, true).value_object(), 0x60BD);
}

TEST(TouchProbe, captures_once_and_rests_until_disarmed) {
  TouchProbe probe = armed(LatchSource::zero_mark);
  EXPECT_EQ(probe.wants_value(), 0);
  probe.on_status(0x0003);
  EXPECT_EQ(probe.wants_value(), 0x60BA);
  probe.on_value(-1234, -1200);
  EXPECT_EQ(probe.latch_counts(), -1234);
  EXPECT_EQ(probe.sequence(), 1u);
  probe.on_status(0x0003);
  probe.on_value(99, 0);
  EXPECT_EQ(probe.sequence(), 1u);
  EXPECT_FALSE(probe.wants_status());
  probe.command(false, LatchSource::zero_mark, false);
  EXPECT_EQ(probe.function(), 0);
  EXPECT_EQ(probe.latch_counts(), -1234) << "the last capture stays";
}

TEST(TouchProbe, a_capture_of_the_time_before_is_not_taken) {
  TouchProbe probe = armed(LatchSource::zero_mark);
  probe.on_status(0x0003);
  probe.on_value(10, 0);
  probe.command(false, LatchSource::zero_mark, false);
  probe.command(true, LatchSource::zero_mark, false);
  probe.on_status(0x0003);  // the drive still shows the old capture
  EXPECT_EQ(probe.wants_value(), 0);
  EXPECT_EQ(probe.function(), 0);
  probe.on_status(0x0000);
  EXPECT_EQ(probe.function(), 0x0015);
  probe.on_status(0x0000);  // not taken over yet
  EXPECT_EQ(probe.wants_value(), 0);
  probe.on_status(0x0001);
  probe.on_status(0x0003);
  probe.on_value(20, 0);
  EXPECT_EQ(probe.sequence(), 2u);
  EXPECT_EQ(probe.latch_counts(), 20);
}

TEST(TouchProbe, the_other_edge_and_the_other_probe_do_not_count) {
  TouchProbe probe = armed(LatchSource::probe_1);
  probe.on_status(0x0005);
  EXPECT_EQ(probe.wants_value(), 0) << "only the negative edge is stored";
  probe.on_status(0x0301);
  EXPECT_EQ(probe.wants_value(), 0) << "that was probe 2";
  probe.on_status(0x0003);
  EXPECT_EQ(probe.wants_value(), 0x60BA);
}

TEST(TouchProbe, a_change_of_source_starts_anew) {
  TouchProbe probe = armed(LatchSource::probe_1);
  probe.command(true, LatchSource::zero_mark, false);
  EXPECT_EQ(probe.function(), 0);
  EXPECT_TRUE(probe.wants_status());
}

TEST(TouchProbe, the_latched_32_bits_are_extended_beside_the_position) {
  const std::int64_t turn = std::int64_t{1} << 32;
  TouchProbe probe = armed(LatchSource::zero_mark);
  probe.on_status(0x0003);
  // The position has run over 2^31; the latch was just before.
  probe.on_value(0x7FFF'FFF0, 3 * turn + 0x8000'0010LL);
  EXPECT_EQ(probe.latch_counts(), 3 * turn + 0x7FFF'FFF0LL);
}

}  // namespace
}  // namespace servogate::canopen
