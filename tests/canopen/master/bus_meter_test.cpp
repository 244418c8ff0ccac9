// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/bus_meter.hpp"

#include <gtest/gtest.h>

#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;

std::uint32_t on_the_wire(const image::CanFrame& f) {
  return image::frame_bits(f) + image::kIntermissionBits;
}

TEST(BusMeter, gives_the_share_of_time_the_bus_was_busy) {
  BusMeter meter;
  const image::CanFrame f = frame(0x181, {1, 2, 3, 4, 5, 6});
  const double share = on_the_wire(f) / 1000.0;
  for (int i = 0; i < 50; ++i) {
    meter.add(f);
    meter.close_cycle(image::kMillisecond, 1'000'000);
  }
  EXPECT_NEAR(meter.load(), share, 1e-12);
  EXPECT_NEAR(meter.worst_cycle(), share, 1e-12);
}

TEST(BusMeter, forgets_what_is_older_than_a_second_but_keeps_the_worst_cycle) {
  BusMeter meter;
  const image::CanFrame f = frame(0x181, {1, 2, 3, 4, 5, 6, 7, 8});
  for (int i = 0; i < 500; ++i) {
    for (int n = 0; n < 5; ++n) meter.add(f);
    meter.close_cycle(image::kMillisecond, 1'000'000);
  }
  const double busy = meter.load();
  for (int i = 0; i < 500; ++i) meter.close_cycle(image::kMillisecond, 1'000'000);
  EXPECT_NEAR(meter.load(), busy / 2, busy * 0.06);
  for (int i = 0; i < 700; ++i) meter.close_cycle(image::kMillisecond, 1'000'000);
  EXPECT_EQ(meter.load(), 0.0);
  EXPECT_NEAR(meter.worst_cycle(), busy, 1e-12);
}

TEST(BusMeter, a_bus_of_unknown_rate_has_no_load) {
  BusMeter meter;
  meter.add(frame(0x181, {1}));
  meter.close_cycle(image::kMillisecond, 0);
  EXPECT_EQ(meter.load(), 0.0);
}

}  // namespace
}  // namespace servogate::canopen
