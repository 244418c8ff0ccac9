// SPDX-License-Identifier: Apache-2.0
// Ramps and set-points against profiles that were computed by hand. Turns, seconds.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

constexpr std::int64_t kTurn = 262'144;

struct DriveProfiles : testing::Test {
  DriveBench b;
  void mode(int m) { ASSERT_EQ(b.write(0x6060, 0, m, 1), 0u); }
  void set(std::uint16_t index, double turns) {
    ASSERT_EQ(b.write(index, 0, std::llround(turns * kTurn), 4), 0u) << std::hex << index;
  }
  double at() { return static_cast<double>(b.drive.object(0x6062)) / kTurn; }
  double speed() { return static_cast<double>(b.drive.object(0x606B)) / kTurn; }
  bool reached() { return b.drive.statusword() & 0x0400; }
  bool acknowledged() { return b.drive.statusword() & 0x1000; }
  /// Milliseconds until the demand is at or beyond this position.
  int until(double turns) {
    int ms = 0;
    while (at() < turns - 1e-6 && ms < 10'000) b.run(1), ++ms;
    return ms;
  }
};

// ---- 60C5h, 60C6h ----

TEST_F(DriveProfiles, a_positioning_keeps_the_maximum_acceleration_and_deceleration) {
  mode(1);
  set(0x6081, 10);
  set(0x6083, 100);
  set(0x6084, 100);
  set(0x60C5, 20);
  set(0x60C6, 10);
  b.enable();
  set(0x607A, 10);
  b.control(0x1F, 0);
  // 0.5 s and 2.5 turns up, 0.25 s at speed, 1 s and 5 turns down.
  b.run(250);
  EXPECT_NEAR(speed(), 5.0, 0.1);
  b.run(350);
  EXPECT_NEAR(speed(), 10.0, 0.01);
  b.run(650);
  EXPECT_NEAR(speed(), 5.0, 0.1);
  b.run(480);
  EXPECT_LT(at(), 10.0) << "after 1.73 s";
  b.run(40);
  EXPECT_NEAR(at(), 10.0, 1e-5) << "after 1.77 s";
}

TEST_F(DriveProfiles, every_ramp_keeps_the_maximum_acceleration_and_deceleration) {
  struct Case {
    const char* what;
    int mode, start_word, stop_word;
  };
  set(0x6083, 1000);
  set(0x6084, 1000);
  set(0x6085, 1000);
  b.write(0x6048, 2, 0, 2);  // vl: at once
  b.write(0x6049, 2, 0, 2);
  set(0x60C5, 20);
  set(0x60C6, 10);
  for (const Case& c : {Case{"pv, quick stop", 3, 0x0F, 0x0B}, Case{"pv, halt", 3, 0x0F, 0x10F},
                        Case{"pv, disable operation", 3, 0x0F, 0x07}, Case{"vl, reference", 2, 0x7F, 0x3F},
                        Case{"vl, no ramp", 2, 0x7F, 0x6F}, Case{"vl, halt", 2, 0x7F, 0x17F}}) {
    mode(c.mode);
    b.write(0x605A, 0, 6, 2);
    b.enable();
    b.write(0x6042, 0, 300, 2);
    set(0x60FF, 5);
    b.control(static_cast<std::uint16_t>(c.start_word), 0);
    const double from = speed();
    b.run(100);
    EXPECT_NEAR(speed() - from, 2.0, 0.05) << c.what;
    b.run(300);
    EXPECT_NEAR(speed(), 5.0, 0.01) << c.what;
    b.control(static_cast<std::uint16_t>(c.stop_word), 0);
    const double before = speed();
    b.run(100);
    EXPECT_NEAR(before - speed(), 1.0, 0.1) << c.what;
    b.run(600);
    b.control(0x00, 20);
  }
}

// ---- 6070h ----

TEST_F(DriveProfiles, speed_is_not_zero_once_it_was_above_606f_for_longer_than_6070) {
  mode(3);
  b.write(0x606F, 0, 5000, 2);
  b.write(0x6070, 0, 200, 2);
  set(0x6083, 1000);
  b.enable();
  set(0x60FF, 1);
  b.run(190);
  EXPECT_TRUE(b.drive.statusword() & 0x1000);
  b.run(30);
  EXPECT_FALSE(b.drive.statusword() & 0x1000);
  set(0x60FF, 0);
  b.run(100);
  EXPECT_TRUE(b.drive.statusword() & 0x1000);
}

// ---- set-points ----

struct DriveSetPoints : DriveProfiles {
  void SetUp() override {
    mode(1);
    set(0x6081, 10);
    set(0x6083, 100);
    set(0x6084, 100);
    b.enable();
  }
  /// New set-point with these bits of the controlword besides bit 4, and bit 4 taken back.
  void set_point(double turns, std::uint16_t bits = 0) {
    set(0x607A, turns);
    b.control(static_cast<std::uint16_t>(0x001F | bits), 0);
    b.run(1);
    b.control(static_cast<std::uint16_t>(0x000F | bits), 0);
  }
  static constexpr std::uint16_t kOnSetPoint = 0x200, kImmediately = 0x20, kRelative = 0x40;
};

TEST_F(DriveSetPoints, the_end_velocity_is_that_at_the_target_and_is_kept_behind_it) {
  set(0x6082, 4);
  set_point(5);
  // 0.5 turns up to 10, (100 - 16) / 200 = 0.42 turns down to 4.
  until(4.5);
  EXPECT_NEAR(speed(), 10.0, 0.01);
  EXPECT_FALSE(reached());
  until(5.0);
  EXPECT_NEAR(speed(), 4.0, 0.15);
  b.run(2);
  EXPECT_TRUE(reached());
  const double from = at();
  b.run(250);
  EXPECT_NEAR(at() - from, 1.0, 0.01);
  EXPECT_NEAR(speed(), 4.0, 0.01);
  set(0x6082, 0);
  set_point(5);
  b.run(800);
  EXPECT_NEAR(at(), 5.0, 1e-5) << "the next set-point fetches it back";
}

TEST_F(DriveSetPoints, an_end_velocity_ends_at_the_software_limit) {
  b.write(0x607D, 2, 6 * kTurn, 4);
  set(0x6082, 4);
  set_point(5);
  b.run(1500);
  EXPECT_NEAR(at(), 6.0, 1e-5);
  EXPECT_TRUE(b.drive.statusword() & 0x0800);
  set_point(9);
  b.run(500);
  EXPECT_NEAR(at(), 6.0, 1e-5) << "no speed at a limit that stands for the target";
}

TEST_F(DriveSetPoints, without_bit_9_each_target_is_reached_before_the_next_motion_begins) {
  b.write(0x6068, 0, 50, 2);
  set_point(5);
  set_point(8);
  until(5.0);
  EXPECT_NEAR(speed(), 0.0, 0.2);
  b.run(40);
  EXPECT_NEAR(at(), 5.0, 1e-5) << "inside the window, not yet for 6068h";
  b.run(40);
  EXPECT_GT(at(), 5.01);
  b.run(1000);
  EXPECT_NEAR(at(), 8.0, 1e-5);
}

TEST_F(DriveSetPoints, with_no_window_time_the_target_is_reached_in_its_window_and_not_on_the_way) {
  b.write(0x6068, 0, 0, 2);
  set_point(5);
  while (at() < 4.9) {
    EXPECT_FALSE(reached()) << at();
    b.run(1);
  }
  b.run(300);
  EXPECT_TRUE(reached());
}

TEST_F(DriveProfiles, with_no_window_time_the_speed_is_reached_in_its_window_and_not_before) {
  mode(3);
  b.write(0x606E, 0, 0, 2);
  set(0x6083, 10);
  b.enable();
  set(0x60FF, 5);
  b.run(2);
  while (speed() < 4.9) {
    EXPECT_FALSE(reached()) << speed();
    b.run(1);
  }
  b.run(50);
  EXPECT_TRUE(reached());
}

TEST_F(DriveSetPoints, with_bit_9_the_set_point_is_passed_with_the_speed_of_its_motion) {
  set_point(5);
  set(0x6081, 4);
  set_point(8, kOnSetPoint);
  EXPECT_TRUE(acknowledged()) << "both places are taken";
  until(4.99);
  EXPECT_NEAR(speed(), 10.0, 0.01) << "6081h of the second motion is not that of the first";
  EXPECT_FALSE(reached());
  until(5.0);
  // 0.42 turns and 0.06 s down to 4, 2.5 turns in 0.625 s, 0.08 turns and 0.04 s to rest.
  b.run(62);
  EXPECT_NEAR(speed(), 4.0, 0.15);
  EXPECT_FALSE(acknowledged());
  EXPECT_FALSE(reached());
  const int rest = until(8.0);
  EXPECT_NEAR(rest, 663, 12);
  b.run(50);
  EXPECT_TRUE(reached());
  EXPECT_NEAR(at(), 8.0, 1e-5);
}

TEST_F(DriveSetPoints, with_bit_9_no_speed_is_kept_that_the_next_target_has_no_room_for) {
  // 0.08 turns further: 4 turns/s is the most from which 100 turns/s^2 stop there.
  set_point(5);
  set_point(5.08, kOnSetPoint);
  until(5.0);
  EXPECT_NEAR(speed(), 4.0, 0.2);
  double most = 0.0;
  for (int ms = 0; ms < 300; ++ms) b.run(1), most = std::max(most, at());
  EXPECT_NEAR(most, 5.08, 1e-4);
}

TEST_F(DriveSetPoints, with_bit_9_a_motion_back_turns_at_the_set_point) {
  set_point(5);
  set_point(2, kOnSetPoint);
  double most = 0.0;
  for (int ms = 0; ms < 2000; ++ms) b.run(1), most = std::max(most, at());
  EXPECT_NEAR(most, 5.0, 1e-4);
  EXPECT_NEAR(at(), 2.0, 1e-5);
}

TEST_F(DriveSetPoints, a_chain_of_relative_set_points_loses_nothing) {
  set_point(1, kRelative);
  for (int i = 0; i < 9; ++i) {
    set_point(1, kRelative | kOnSetPoint);
    for (int ms = 0; acknowledged() && ms < 1000; ++ms) b.run(1);
  }
  b.run(500);
  EXPECT_NEAR(at(), 10.0, 1e-5);
}

TEST_F(DriveSetPoints, a_third_set_point_is_not_taken_unless_it_is_immediate) {
  set_point(5);
  set_point(8);
  set_point(2);
  EXPECT_TRUE(acknowledged());
  b.run(2000);
  EXPECT_NEAR(at(), 8.0, 1e-5);
  set_point(5);
  set_point(8);
  set_point(2, kImmediately);
  b.run(2000);
  EXPECT_NEAR(at(), 2.0, 1e-5);
}

TEST_F(DriveSetPoints, values_written_during_a_motion_are_those_of_the_next_one) {
  set_point(20);
  b.run(200);
  set(0x6081, 2);
  b.run(200);
  EXPECT_NEAR(speed(), 10.0, 0.01);
  set_point(20, kImmediately);
  b.run(200);
  EXPECT_NEAR(speed(), 2.0, 0.01);
}

}  // namespace
}  // namespace servogate::mock
