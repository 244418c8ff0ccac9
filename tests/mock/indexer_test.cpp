// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/indexer/indexer.hpp"

#include <gtest/gtest.h>

#include <random>

namespace servogate::mock {
namespace {

constexpr image::Nanoseconds kMs = image::kMillisecond;

TEST(Indexer, stands_where_it_starts_until_the_motor_runs) {
  Indexer turret(3, 600 * kMs, 2);
  for (int t = 0; t < 5000; t += 7) {
    turret.advance_to(t * kMs, false);
    ASSERT_EQ(turret.position(), 2);
  }
}

TEST(Indexer, shows_no_position_for_the_first_half_of_a_step_and_the_next_one_for_the_second) {
  Indexer turret(3, 600 * kMs);
  turret.advance_to(0, true);
  turret.advance_to(299 * kMs, true);
  EXPECT_EQ(turret.position(), -1);
  turret.advance_to(300 * kMs, true);
  EXPECT_EQ(turret.position(), 1);
  turret.advance_to(600 * kMs, true);
  EXPECT_EQ(turret.position(), 1);
  turret.advance_to(601 * kMs, true);
  EXPECT_EQ(turret.position(), -1);
  turret.advance_to(1800 * kMs, true);
  EXPECT_EQ(turret.position(), 0) << "once round";
}

TEST(Indexer, turns_only_as_long_as_the_motor_ran_whatever_the_steps_of_time) {
  std::mt19937_64 random(20'261'121);
  for (int n = 0; n < 2000; ++n) {
    const int positions = 1 + static_cast<int>(random() % 12);
    const image::Nanoseconds step = 2 + static_cast<image::Nanoseconds>(random() % 1000);
    const int start = static_cast<int>(random() % static_cast<unsigned>(positions));
    Indexer turret(positions, step, start);
    image::Nanoseconds t = 0, turned = start * step;
    bool motor = false;
    for (int k = 0; k < 50; ++k) {
      const auto wait = static_cast<image::Nanoseconds>(random() % 700);
      t += wait;
      if (motor) turned += wait;
      motor = random() % 2 == 0;
      turret.advance_to(t, motor);
    }
    const image::Nanoseconds phase = turned % step;
    const int behind = static_cast<int>(turned / step % positions);
    const int expected = phase == 0 ? behind : 2 * phase < step ? -1 : (behind + 1) % positions;
    ASSERT_EQ(turret.position(), expected);
  }
}

}  // namespace
}  // namespace servogate::mock
