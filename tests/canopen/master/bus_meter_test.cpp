// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/bus_meter.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/mock/can/frame_bits.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;

image::CanFrame random_frame(std::mt19937& random) {
  image::CanFrame f;
  f.extended = random() % 4 == 0;
  f.remote = random() % 8 == 0;
  f.id = random() & (f.extended ? 0x1FFFFFFFu : 0x7FFu);
  f.length = static_cast<std::uint8_t>(random() % 9);
  // Long runs of equal bits are what stuffing is about.
  const unsigned kind = random() % 3;
  for (auto& byte : f.data) byte = kind == 0 ? 0x00 : kind == 1 ? 0xFF : static_cast<std::uint8_t>(random());
  return f;
}

TEST(WireBits, agrees_with_the_simulated_wire_bit_by_bit) {
  constexpr unsigned kSeed = 11898;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 100'000; ++i) {
    const image::CanFrame f = random_frame(random);
    ASSERT_EQ(wire_bits(f), mock::frame_bits(f) + mock::kIntermissionBits)
        << "seed " << kSeed << " case " << i << ": " << testing::show(f);
  }
}

TEST(WireBits, never_exceeds_the_worst_case) {
  constexpr unsigned kSeed = 1;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 100'000; ++i) {
    const image::CanFrame f = random_frame(random);
    if (f.remote) continue;
    ASSERT_LE(wire_bits(f), image::worst_case_bits(f.length, f.extended));
    ASSERT_GE(wire_bits(f), 8u * f.length + (f.extended ? 67u : 47u));
  }
}

TEST(WireBits, counts_the_stuff_bits_of_a_frame_worked_out_by_hand) {
  // Identifier 0, no data: start of frame, 18 header bits and a CRC of 0 are 34 dominant bits in a row; every
  // five of them are followed by a recessive stuff bit: 6.
  EXPECT_EQ(wire_bits(frame(0x000, {})), 47u + 6u);
}

TEST(BusMeter, gives_the_share_of_time_the_bus_was_busy) {
  BusMeter meter;
  const image::CanFrame f = frame(0x181, {1, 2, 3, 4, 5, 6});
  const double share = wire_bits(f) / 1000.0;
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
