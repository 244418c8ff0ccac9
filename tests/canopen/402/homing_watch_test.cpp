// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/homing_watch.hpp"

#include <gtest/gtest.h>

namespace servogate::canopen {
namespace {

using image::DriveHoming;
using namespace statusword;

constexpr std::uint16_t kAttained = kTargetReached | kModeSpecific12;

struct Started : testing::Test {
  HomingWatch watch;
  image::Nanoseconds now = 0;
  void SetUp() override { watch.command(now, true); }
  DriveHoming see(std::uint16_t word, image::Nanoseconds later = image::kMillisecond) {
    now += later;
    watch.command(now, true);
    watch.on_statusword(word);
    return watch.state();
  }
};

TEST_F(Started, bits_of_the_last_homing_count_for_nothing_until_the_drive_was_seen_running) {
  EXPECT_EQ(see(kAttained), DriveHoming::running);
  EXPECT_EQ(see(kModeSpecific13 | kTargetReached), DriveHoming::running);
  EXPECT_EQ(see(0), DriveHoming::running);
  EXPECT_EQ(see(kModeSpecific12), DriveHoming::running) << "found, still moving";
  EXPECT_EQ(see(kAttained), DriveHoming::attained);
}

TEST_F(Started, a_drive_that_is_never_seen_running_is_believed_after_a_while) {
  EXPECT_EQ(see(kAttained, HomingWatch::kSettleNs - 1), DriveHoming::running);
  EXPECT_EQ(see(kAttained, 1), DriveHoming::attained);
}

TEST_F(Started, the_error_bit_counts_while_the_drive_still_moves_and_a_rest_without_home_is_an_interruption) {
  see(0);
  EXPECT_EQ(see(kTargetReached), DriveHoming::interrupted);
  EXPECT_EQ(see(kModeSpecific13), DriveHoming::failed);
}

TEST_F(Started, without_the_start_bit_nothing_is_known) {
  see(0);
  watch.command(now, false);
  EXPECT_EQ(watch.state(), DriveHoming::idle);
  watch.on_statusword(kAttained);
  EXPECT_EQ(watch.state(), DriveHoming::idle);
}

}  // namespace
}  // namespace servogate::canopen
