// SPDX-License-Identifier: Apache-2.0
// What the ISO dialect and Fenix ask of a process that the other programs of this folder do not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;

/// The largest speed of X, mm/s, between two places of it.
double fastest(const Rig& rig, double from, double to) {
  double most = 0.0;
  for (std::size_t i = 1; i < rig.path.size(); ++i)
    if (rig.path[i][0] > from && rig.path[i][0] < to)
      most = std::max(most, (rig.path[i][0] - rig.path[i - 1][0]) * 1000.0);
  return most;
}

TEST(FeedOverride, does_not_count_in_a_tapping_mode_and_counts_behind_it) {
  Rig rig("G01 X20. F600\nG63 X40.\nG64 X60.\nM30\n", "", 0.5, RigKind::iso);
  ASSERT_EQ(rig.ask(RequestKind::override_feed, 0.5), cycle::Refusal::none);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_NEAR(fastest(rig, 5.0, 15.0), 5.0, 0.01);
  EXPECT_NEAR(fastest(rig, 25.0, 35.0), 10.0, 0.01);
  EXPECT_NEAR(fastest(rig, 45.0, 55.0), 5.0, 0.01);
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedOverride, of_zero_does_not_stop_a_tapping_mode_but_a_hold_does) {
  Rig rig("G63 G01 X20. F600\nM30\n", "", 0.5, RigKind::iso);
  ASSERT_EQ(rig.ask(RequestKind::override_feed, 0.0), cycle::Refusal::none);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 5.0; }));
  ASSERT_EQ(rig.ask(RequestKind::hold), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return !rig.moving(); }));
  EXPECT_LT(rig.x(), 19.0);
}

TEST(FeedOverride, counts_again_however_a_program_ends_in_its_tapping_mode) {
  for (const RequestKind ends : {RequestKind::stop, RequestKind::reset}) {
    Rig rig("G63 G01 X20. F600\nM30\n", "", 0.5, RigKind::iso);
    ASSERT_EQ(rig.ask(RequestKind::override_feed, 0.5), cycle::Refusal::none);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x() > 5.0; }));
    EXPECT_EQ(rig.status().override_ratio, 1.0);
    EXPECT_EQ(rig.ask(ends), cycle::Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::idle; }));
    rig.run(0.01);
    EXPECT_EQ(rig.status().override_ratio, 0.5);
  }
}

TEST(SpindleTurn, of_Fenix_goes_by_its_angle_before_the_next_motion_begins) {
  Rig rig("%\nN1 M19\nN2 G15(720) S100\nN3 G15(-90)\nN4 G1 Z5 F600\nN5 M30\n", "", 0.5, RigKind::fenix);
  double oriented = 0.0, turned = 0.0;
  bool turns = false;
  rig.each = [&] {
    const bool fast =
        std::abs(rig.image().spindles[0].command_rpm) > 70.0;  // faster than it looks for its mark
    if (fast && !turns) oriented = rig.drives.turns;
    turns = turns || fast;
    if (rig.x(2) == 0.0) turned = rig.drives.turns;
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  ASSERT_TRUE(turns);
  EXPECT_NEAR(turned - oriented, 1.75, 0.1);
  EXPECT_NEAR(turned - std::floor(turned), 0.75, 0.005) << "from the oriented stop at its zero mark";
  EXPECT_EQ(rig.violations(), "");
}

}  // namespace
}  // namespace servogate::channel::test
