// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/firmware/step_generator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/property_seed.hpp"

namespace servogate::board {
namespace {

/// A motor on the pins: counts rising edges, and judges their timing.
struct Motor {
  std::int64_t at = 0;
  std::uint32_t ticks_at_level = 1000, shortest = 1000, fastest = 0;
  std::uint32_t since_step = 1'000'000, since_direction = 1'000'000, shortest_setup = 1'000'000;
  StepPins before;
  void tick(StepPins pins) {
    ++since_step;
    ++since_direction;
    ++ticks_at_level;
    if (pins.forward != before.forward) since_direction = 0;
    if (pins.step != before.step) {
      shortest = std::min(shortest, ticks_at_level);
      ticks_at_level = 0;
    }
    if (pins.step && !before.step) {
      at += pins.forward ? 1 : -1;
      shortest_setup = std::min(shortest_setup, since_direction);
      since_step = 0;
    }
    before = pins;
  }
};

constexpr StepGenerator::Setting kSetting{50'000, 50, 1, 200'000};

TEST(StepGenerator, reaches_each_target_within_a_step_a_period_after_its_command) {
  StepGenerator g;
  g.configure(kSetting);
  Motor motor;
  for (int cycle = 0; cycle < 3000; ++cycle) {
    const double t = cycle * 0.001;
    const auto target = static_cast<std::int32_t>(std::lround(2000.0 * std::sin(6.0 * t)));
    ASSERT_TRUE(g.follow(target, static_cast<std::int32_t>(12000.0 * std::cos(6.0 * t))));
    for (std::uint32_t tick = 0; tick < kSetting.period_ticks; ++tick) motor.tick(g.tick());
    EXPECT_LE(std::llabs(motor.at - target), 1) << cycle;
    EXPECT_EQ(motor.at, g.steps());
  }
}

TEST(StepGenerator, keeps_its_levels_and_sets_the_direction_before_a_step) {
  std::mt19937_64 random(test::property_seed());
  for (int n = 0; n < 200; ++n) {
    const StepGenerator::Setting setting{static_cast<std::uint32_t>(10'000 + random() % 100'000),
                                         static_cast<std::uint32_t>(10 + random() % 100),
                                         static_cast<std::uint32_t>(1 + random() % 4), 50'000};
    StepGenerator g;
    g.configure(setting);
    Motor motor;
    std::int32_t target = 0;
    for (int cycle = 0; cycle < 100; ++cycle) {
      target += static_cast<std::int32_t>(random() % 41) - 20;
      g.follow(target, static_cast<std::int32_t>(random() % 20'000) - 10'000);
      const auto late = static_cast<std::uint32_t>(random() % 20);
      for (std::uint32_t tick = 0; tick < setting.period_ticks + late; ++tick) motor.tick(g.tick());
    }
    EXPECT_GE(motor.shortest, setting.level_ticks);
    EXPECT_GE(motor.shortest_setup, 1u);
    EXPECT_EQ(motor.at, g.steps());
  }
}

TEST(StepGenerator, says_that_a_target_is_too_far_and_catches_up) {
  StepGenerator g;
  g.configure(kSetting);
  Motor motor;
  const auto largest = static_cast<std::int32_t>(StepGenerator::largest_rate(kSetting) / 1000);
  EXPECT_TRUE(g.follow(largest, 0));
  EXPECT_FALSE(g.follow(10 * largest, 0));
  for (int cycle = 0; cycle < 20; ++cycle) {
    g.follow(10 * largest, 0);
    for (std::uint32_t tick = 0; tick < kSetting.period_ticks; ++tick) motor.tick(g.tick());
  }
  EXPECT_EQ(motor.at, 10 * largest);
}

TEST(StepGenerator, runs_down_to_rest_when_commands_stay_away) {
  StepGenerator g;
  g.configure(kSetting);
  Motor motor;
  std::int32_t target = 0;
  for (int cycle = 0; cycle < 200; ++cycle) {
    g.follow(target += 10, 10'000);
    for (std::uint32_t tick = 0; tick < kSetting.period_ticks; ++tick) motor.tick(g.tick());
  }
  // 10 000 steps/s against 200 000 steps/s2: 50 ms and 250 steps, behind one period at the rate of the
  // command.
  for (std::uint32_t tick = 0; tick < 2 * 2500 + 2 * kSetting.period_ticks; ++tick) motor.tick(g.tick());
  EXPECT_NEAR(static_cast<double>(motor.at - target), 10 + 250, 2.0);
  const std::int64_t rest = motor.at;
  for (int tick = 0; tick < 10'000; ++tick) motor.tick(g.tick());
  EXPECT_EQ(motor.at, rest);
}

TEST(StepGenerator, counts_on_when_its_numbers_run_over) {
  StepGenerator g;
  g.configure(kSetting);
  Motor motor;
  std::uint32_t target = 0;
  // Near the end of 32 bits by jumps of the target alone would take hours: the difference is what counts.
  for (int cycle = 0; cycle < 4000; ++cycle) {
    g.follow(static_cast<std::int32_t>(target -= 20), -20'000);
    for (std::uint32_t tick = 0; tick < kSetting.period_ticks; ++tick) motor.tick(g.tick());
  }
  EXPECT_EQ(motor.at, -80'000);
}

}  // namespace
}  // namespace servogate::board
