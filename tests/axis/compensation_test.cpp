// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/control/compensation.hpp"

#include <gtest/gtest.h>

#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

using test::Judge;
using test::Rig;

AxisConfig with_table() {
  AxisConfig c = test::mill_axis();
  c.backlash = 0.04;
  c.pitch = {
      {-300, 0.030, 0.035}, {-100, -0.010, -0.012}, {0, 0.005, 0.002}, {150, 0.020, 0.030}, {300, 0.0, 0.0}};
  c.homing.position = 0.0;
  c.homing.release_direction = 1;
  return c;
}

TEST(Compensation, is_nothing_without_backlash_and_table) {
  Compensation k;
  k.configure(test::mill_axis());
  EXPECT_FALSE(k.present());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(k.step(i * 0.1 * (i % 3 - 1), 0.001), 0.0);
}

TEST(Compensation, interpolates_the_table_and_is_zero_at_home_in_the_direction_of_homing) {
  Compensation k;
  k.configure(with_table());
  EXPECT_EQ(k.at(0.0), 0.0);
  EXPECT_NEAR(k.at(75.0), 0.0125 - 0.005, 1e-12);
  EXPECT_NEAR(k.at(-200.0), 0.010 - 0.005, 1e-12);
  EXPECT_NEAR(k.at(1000.0), 0.0 - 0.005, 1e-12) << "outside the table its end value holds";
  EXPECT_NEAR(k.at(-1000.0), 0.030 - 0.005, 1e-12);
}

TEST(Compensation, takes_up_the_backlash_on_reversal_by_a_ramp_within_the_limits_of_the_axis) {
  const AxisConfig c = with_table();
  Compensation k;
  k.configure(c);
  Judge judge(k.step(0.0, 0.001), 0.001);
  for (int i = 1; i <= 10; ++i) judge.add(k.step(i * 1e-4, 0.001));
  for (int i = 10; i >= -500; --i) judge.add(k.step(i * 1e-4, 0.001));
  EXPECT_EQ(k.side(), 0.0);
  // at 0 in the negative direction: the table says 0.002, the zero at home took 0.005 and the backlash away
  EXPECT_NEAR(k.at(0.0), 0.002 - 0.005 - 0.04, 1e-12);
  EXPECT_TRUE(judge.within(c.limits));
}

TEST(Compensation, moves_the_drive_by_the_whole_backlash_and_nothing_more) {
  AxisConfig c = with_table();
  c.pitch.clear();
  Compensation k;
  k.configure(c);
  k.step(0.0, 0.001);
  double last = 0.0;
  for (int i = 1; i < 1000; ++i) last = k.step(i * 0.001, 0.001);
  EXPECT_EQ(last, 0.0);
  for (int i = 1000; i > 0; --i) last = k.step(i * 0.001, 0.001);
  EXPECT_NEAR(last, -0.04, 1e-12);
  for (int i = 0; i < 1000; ++i) last = k.step(i * 0.001, 0.001);
  EXPECT_NEAR(last, 0.0, 1e-12);
}

TEST(Compensation, does_not_take_rounding_for_a_reversal) {
  AxisConfig c = with_table();
  Compensation k;
  k.configure(c);
  for (int i = 0; i < 1000; ++i) k.step(5.0 + (i % 2) * 1e-4, 0.001);  // a tenth of a count
  EXPECT_EQ(k.side(), 1.0);
}

TEST(Axis, with_compensation_sends_position_and_correction_and_reads_its_position_back_without_it) {
  Rig rig(with_table());
  rig.axis.set_reference(0);
  ASSERT_TRUE(rig.enable());
  const std::pair<double, double> kGoals[] = {
      {120.0, 0.017 - 0.005},     // table upwards, zero at home
      {-250.0, 0.02325 - 0.045},  // table downwards, the backlash taken up
      {33.0, 0.0083 - 0.005},
      {32.0, 0.002 + 0.028 * 32 / 150 - 0.045},
      {290.0, 0.02 / 15 - 0.005}};
  for (const auto& [goal, expected] : kGoals) {
    ASSERT_TRUE(rig.axis.move_to(goal, 200.0));
    while (rig.axis.moving()) {
      rig.cycle();
      ASSERT_LT(std::abs(rig.shared().following_error), 0.0006);
    }
    rig.run(200);
    EXPECT_NEAR(rig.shared().actual, goal, 0.0006);
    const auto sent = static_cast<double>(rig.shared().drive_command.position_counts) / 1000.0;
    EXPECT_NEAR(sent - goal, expected, 0.0006) << goal;
  }
  EXPECT_TRUE(rig.events.empty());
}

TEST(Axis, with_compensation_does_not_jump_when_it_is_enabled_homed_again_or_loses_its_reference) {
  Rig rig(with_table());
  rig.axis.set_reference(0);
  rig.drive.start_at(-150'000);
  rig.run(3);
  rig.axis.request_power(true);
  std::int64_t last = rig.drive.counts;
  for (int i = 0; i < 200; ++i) {
    rig.cycle();
    ASSERT_EQ(rig.shared().drive_command.position_counts, last) << i;
  }
  ASSERT_TRUE(rig.shared().enabled);
  ASSERT_TRUE(rig.axis.home());
  std::int64_t before = last;
  while (rig.axis.homing().active()) {
    rig.cycle();
    const std::int64_t now = rig.shared().drive_command.position_counts;
    ASSERT_LE(std::abs(now - before), 51) << "faster than the search (50 mm/s)";
    before = now;
  }
  ASSERT_TRUE(rig.axis.homed());
  rig.run(100);
  EXPECT_NEAR(rig.axis.scale().position(rig.axis.reference_counts()), 0.0, 1e-12);
  EXPECT_LT(std::abs(rig.shared().following_error), 0.0011);
}

}  // namespace
}  // namespace servogate::axis
