// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/display.hpp"

#include <gtest/gtest.h>

#include "tests/pendant/makes.hpp"

namespace servogate::pendant {
namespace {

using Reports = std::vector<std::vector<std::uint8_t>>;

TEST(PendantDisplay, CoordinatesFeedAndSpindleStandWhereTheLayoutSays) {
  Shown shown;
  shown.work = {1.5, -20.25, 300.001};
  shown.feed_mm_min = 1200.0;
  shown.spindle_rpm = -500.0;
  // 1.5 = 1 and 5000; -20.25 = 20 and 2500 with its sign; 300.001 = 300 and 10.
  const Reports expected{{6, 0xFE, 0xFD, 0x0C, 0x81, 1, 0, 0x88},
                         {6, 0x13, 20, 0, 0xC4, 0x89, 0x2C, 0x01},
                         {6, 10, 0, 0xB0, 0x04, 0xF4, 0x01, 0}};
  EXPECT_EQ(show(test::with_selectors(), shown), expected);
}

TEST(PendantDisplay, TheRowsAreThoseOfTheSelectedAxis) {
  Shown shown;
  shown.work = {1.0, 2.0, 3.0, 4.0};
  shown.selected = 3;
  const Reports reports = show(test::with_selectors(), shown);
  EXPECT_EQ(reports[0][5], 4) << "A in the first row";
  EXPECT_EQ(reports[1][2], 2) << "Y in the second one, as there is no B";
}

TEST(PendantDisplay, MachineCoordinatesAndAnAlarmAreFlagged) {
  Shown shown;
  shown.machine = {7.0};
  shown.machine_coordinates = shown.reset = true;
  const Reports reports = show(test::with_selectors(), shown);
  EXPECT_EQ(reports[0][4], 0x41);
  EXPECT_EQ(reports[0][5], 7);
}

TEST(PendantDisplay, ValuesBeyondTheDisplayStayAtItsEnd) {
  Shown shown;
  shown.work = {1e9, -1e300, std::numeric_limits<double>::quiet_NaN()};
  shown.feed_mm_min = 1e9;
  const Reports reports = show(test::with_selectors(), shown);
  EXPECT_EQ(reports[0][5], 0xFF);
  EXPECT_EQ(reports[0][6], 0xFF);
  EXPECT_EQ(reports[2][3], 0xFF);
}

TEST(PendantDisplay, ATinyNegativeValueIsShownWithoutASign) {
  Shown shown;
  shown.work = {-0.0001};
  EXPECT_EQ(show(test::with_selectors(), shown)[1][1], 0);
}

TEST(PendantDisplay, APendantWithoutDisplayIsSentNothing) {
  EXPECT_TRUE(show(test::with_ring(), {}).empty());
}

}  // namespace
}  // namespace servogate::pendant
