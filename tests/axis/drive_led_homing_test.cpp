// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/homing/drive_led_homing.hpp"

#include <gtest/gtest.h>

namespace servogate::axis {
namespace {

using image::DriveMode;
using Outcome = DriveLedHoming::Outcome;
using Phase = DriveLedHoming::Phase;

/// The order of a homing by the drive, which stands in csp at the start.
struct DriveLed : testing::Test {
  DriveLedHoming homing;
  HomingData data;
  DriveLedInputs in{.mode = DriveMode::csp};
  void SetUp() override { homing.start(); }
  void pass(double seconds) {
    for (double t = 0.0; t < seconds; t += in.dt) homing.step(data, in);
  }
  void run() {
    in.mode = DriveMode::homing;
    in.homing = image::DriveHoming::running;
    in.standing = false;
    pass(0.01);
    ASSERT_EQ(homing.phase(), Phase::running);
  }
};

TEST_F(DriveLed, a_drive_that_never_shows_homing_mode_is_given_up_and_asked_back) {
  pass(DriveLedHoming::kModePatience - 0.1);
  EXPECT_EQ(homing.phase(), Phase::asking);
  EXPECT_TRUE(homing.wants_homing_mode());
  pass(0.3);
  EXPECT_EQ(homing.outcome(), Outcome::mode_refused);
  EXPECT_FALSE(homing.leads()) << "it stands and is in csp";
}

TEST_F(DriveLed, a_drive_that_does_not_come_back_into_csp_is_no_homed_one) {
  run();
  in.homing = image::DriveHoming::attained;
  in.standing = true;
  pass(0.01);
  EXPECT_EQ(homing.phase(), Phase::returning);
  EXPECT_EQ(homing.outcome(), Outcome::attained);
  pass(DriveLedHoming::kModePatience + 0.1);
  EXPECT_EQ(homing.outcome(), Outcome::mode_refused);
  EXPECT_TRUE(homing.leads()) << "the axis must not lead a drive in another mode";
  in.mode = DriveMode::csp;
  pass(0.01);
  EXPECT_FALSE(homing.leads());
}

TEST_F(DriveLed, home_is_found_when_the_drive_stands_and_not_before) {
  run();
  in.homing = image::DriveHoming::attained;
  pass(0.1);
  EXPECT_EQ(homing.phase(), Phase::running);
  in.standing = true;
  pass(0.01);
  in.mode = DriveMode::csp;
  pass(0.01);
  EXPECT_EQ(homing.outcome(), Outcome::attained);
  EXPECT_FALSE(homing.leads());
}

TEST_F(DriveLed, a_halt_that_stops_nothing_becomes_a_quick_stop) {
  run();
  homing.stop();
  EXPECT_TRUE(homing.wants_halt());
  pass(DriveLedHoming::kHaltPatience - 0.1);
  EXPECT_FALSE(homing.wants_quick_stop());
  pass(0.2);
  EXPECT_TRUE(homing.wants_quick_stop());
  EXPECT_TRUE(homing.wants_homing_mode()) << "no change of mode in motion";
}

TEST_F(DriveLed, a_moment_of_rest_is_no_standstill) {
  run();
  homing.stop();
  in.standing = true;
  pass(0.03);
  in.standing = false;
  pass(0.03);
  in.standing = true;
  pass(0.03);
  EXPECT_EQ(homing.phase(), Phase::halting);
  pass(0.03);
  EXPECT_EQ(homing.phase(), Phase::returning);
}

TEST_F(DriveLed, may_be_on_a_limit_switch_as_long_as_its_method_needs_to_turn_round) {
  data.drive_limit_time = 0.5;
  run();
  in.into_limit = true;
  pass(0.4);
  in.into_limit = false;
  pass(0.4);
  in.into_limit = true;
  pass(0.4);
  EXPECT_EQ(homing.phase(), Phase::running) << "each time anew";
  pass(0.2);
  EXPECT_EQ(homing.outcome(), Outcome::limit);
  EXPECT_TRUE(homing.wants_halt());
}

TEST_F(DriveLed, a_stop_while_it_goes_back_into_csp_throws_the_home_away) {
  run();
  in.homing = image::DriveHoming::attained;
  in.standing = true;
  pass(0.01);
  homing.stop();
  in.mode = DriveMode::csp;
  pass(0.01);
  EXPECT_EQ(homing.outcome(), Outcome::interrupted);
}

}  // namespace
}  // namespace servogate::axis
