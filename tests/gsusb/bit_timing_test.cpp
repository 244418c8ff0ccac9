// SPDX-License-Identifier: Apache-2.0
#include "drivers/gsusb/bit_timing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/property_seed.hpp"

namespace servogate::gsusb {
namespace {

/// bxCAN of an STM32F0 at 48 MHz, FDCAN of an STM32G4 at 40 MHz: common adapters.
constexpr TimingLimits kBxcan{48'000'000, 1, 16, 1, 8, 4, 1, 1024, 1};
constexpr TimingLimits kFdcan{40'000'000, 2, 256, 2, 128, 128, 1, 512, 1};

TEST(BitTiming, common_adapters_make_every_rate_of_CiA_301_exactly_at_its_sample_point) {
  for (const TimingLimits& limits : {kBxcan, kFdcan})
    for (const std::uint32_t rate :
         {1'000'000u, 800'000u, 500'000u, 250'000u, 125'000u, 50'000u, 20'000u, 10'000u}) {
      const auto t = find_timing(limits, rate);
      ASSERT_TRUE(t) << rate;
      EXPECT_DOUBLE_EQ(t->bit_rate(limits.clock_hz), rate);
      EXPECT_NEAR(t->sample_point(), recommended_sample_point(rate), 0.0126) << rate;
    }
}

TEST(BitTiming, bxcan_reads_500_kbit_at_seven_eighths_of_16_quanta) {
  const auto t = find_timing(kBxcan, 500'000);
  ASSERT_TRUE(t);
  EXPECT_EQ(t->quanta(), 16u);
  EXPECT_EQ(t->prescaler, 6u);
  EXPECT_EQ(t->phase_2, 2u);
  EXPECT_EQ(t->propagation + t->phase_1, 13u);
  EXPECT_EQ(t->jump_width, 1u);
}

TEST(BitTiming, a_clock_that_does_not_have_the_rate_is_told) {
  TimingLimits limits = kBxcan;
  limits.clock_hz = 7'372'800;  // a crystal for serial lines
  EXPECT_FALSE(find_timing(limits, 1'000'000));
  EXPECT_FALSE(find_timing(kBxcan, 0));
  EXPECT_FALSE(find_timing({}, 500'000));
}

TEST(BitTiming, whatever_the_limits_a_setting_found_keeps_to_them) {
  std::mt19937_64 random(test::property_seed());
  const auto pick = [&](std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(random() % (high - low + 1));
  };
  int found = 0;
  for (int i = 0; i < 5000; ++i) {
    TimingLimits l;
    l.clock_hz = pick(1, 160) * 1'000'000;
    l.segment_1_min = pick(1, 3), l.segment_1_max = l.segment_1_min + pick(0, 255);
    l.segment_2_min = pick(1, 3), l.segment_2_max = l.segment_2_min + pick(0, 127);
    l.jump_width_max = pick(1, 16);
    l.prescaler_min = pick(1, 4), l.prescaler_max = l.prescaler_min + pick(0, 1023),
    l.prescaler_step = pick(1, 2);
    const std::uint32_t rate = pick(1, 100) * 10'000;
    const auto t = find_timing(l, rate);
    if (!t) continue;
    ++found;
    const std::uint32_t segment_1 = t->propagation + t->phase_1;
    ASSERT_GE(segment_1, l.segment_1_min);
    ASSERT_LE(segment_1, l.segment_1_max);
    ASSERT_GE(t->phase_2, l.segment_2_min);
    ASSERT_LE(t->phase_2, l.segment_2_max);
    ASSERT_GE(t->jump_width, 1u);
    ASSERT_LE(t->jump_width,
              std::min({l.jump_width_max, std::max(t->phase_2, 1u), std::max(t->phase_1, 1u)}));
    ASSERT_EQ((t->prescaler - l.prescaler_min) % l.prescaler_step, 0u);
    ASSERT_LE(t->prescaler, l.prescaler_max);
    ASSERT_LE(std::abs(t->bit_rate(l.clock_hz) / rate - 1.0), 0.001);
  }
  EXPECT_GT(found, 500);
}

}  // namespace
}  // namespace servogate::gsusb
