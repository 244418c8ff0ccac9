// SPDX-License-Identifier: Apache-2.0
// The example mill with its spindle on a frequency inverter in velocity mode (vl), behind a gear.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

TEST(VlSpindle, turns_both_ways_at_the_programmed_speed_and_has_the_limits_of_the_machine_file) {
  Mill mill(
      changed_mill([](std::string& text) {
        replace(text, "device = \"spindle-cia402-slow\"", "device = \"inverter-cia402-vl\"");
        replace(
            text, "min_speed = \"50 rpm\"\nmax_speed = \"6000 rpm\"\nacceleration = \"3000 rpm/s\"",
            "min_speed = \"50 rpm\"\nmax_speed = \"1500 rpm\"\nacceleration = \"1000 rpm/s\"\ngear = [2, 1]");
      }),
      "N10 G90 G94 G71\nN20 S1200 M3\nN30 G1 X20 F600\nN40 S900 M4\nN50 X0\nN60 M5\nN70 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mock::SimulatedDrive& drive = *mill.control().world().drive("can.spindle");
  EXPECT_EQ(drive.object(0x6046, 1), 1'000) << "50 rpm behind 2 to 1, in tenths";
  EXPECT_EQ(drive.object(0x6046, 2), 30'000);
  EXPECT_EQ(drive.object(0x6048, 1), 20'000);
  EXPECT_EQ(drive.object(0x6048, 2), 1);
  EXPECT_EQ(drive.object(0x604A, 1), 20'000);
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return drive.object(0x6042) == 24'000; }, 20.0)) << mill.alarm_list();
  mill.run(0.5);
  EXPECT_TRUE(mill.image().spindles[0].at_speed);
  EXPECT_NEAR(mill.image().spindles[0].actual_rpm, 1200.0, 3.0);
  ASSERT_TRUE(mill.until([&] { return drive.object(0x6042) == -18'000; }, 20.0)) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.image().spindles[0].at_speed; }, 10.0));
  EXPECT_NEAR(mill.image().spindles[0].actual_rpm, -900.0, 45.0);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }, 60.0))
      << mill.alarm_list();
  EXPECT_NEAR(drive.velocity_counts_s(), 0.0, 100.0);
}

}  // namespace
}  // namespace servogate::machine_run
