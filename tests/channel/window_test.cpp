// SPDX-License-Identifier: Apache-2.0
// The window of the exact stop that a program sets: DTL of the NC-110.
#include <gtest/gtest.h>

#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;
using image::WaitReason;

constexpr double kOwn = 0.002;  ///< of the rig's axes, mm

double window(const Rig& rig, std::size_t axis = 0) { return rig.cycle->axes()[axis].in_position_window(); }

/// X stays where it is as soon as its set-point is beyond `at`, and so stands off by a little less than 20 -
/// at.
void stick_beyond(Rig& rig, double at) {
  rig.each = [&rig, at] { rig.drives.stuck[0] = rig.x() > at; };
}

TEST(Window, of_a_program_decides_when_an_exact_stop_is_over) {
  Rig rig("N10 G29\nN20 (DTL,X0.05)\nN30 G1 X20 F600\nN40 G1 Y5\nN50 M30\n");
  stick_beyond(rig, 19.97);
  EXPECT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_NEAR(rig.x(1), 5.0, 1e-9);
}

TEST(Window, of_the_machine_holds_where_the_program_sets_none) {
  Rig rig("N10 G29\nN30 G1 X20 F600\nN40 G1 Y5\nN50 M30\n");
  stick_beyond(rig, 19.97);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == WaitReason::in_position; }));
  rig.run(1.0);
  EXPECT_EQ(rig.x(1), 0.0) << "Y does not begin while X is not where it should be";
}

TEST(Window, is_set_in_the_order_of_the_path_for_the_axes_that_are_named) {
  Rig rig("N10 G29 G1 X5 F600\nN20 (DTL,X0.05,Y0.1)\nN30 M0\nN40 (DTL,X0)\nN50 M0\nN60 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 1.0; }));
  EXPECT_EQ(window(rig), kOwn) << "the motion before it has not ended";
  ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == WaitReason::program_stop; }));
  EXPECT_EQ(window(rig, 0), 0.05);
  EXPECT_EQ(window(rig, 1), 0.1);
  EXPECT_EQ(window(rig, 2), kOwn);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().line == 5; }));
  EXPECT_EQ(window(rig, 0), kOwn) << "0 brings the machine's own back";
  EXPECT_EQ(window(rig, 1), 0.1);
}

TEST(Window, is_the_machines_again_however_the_program_ends) {
  Rig rig("N10 G29\nN20 (DTL,X0.05)\nN30 M0\nN40 M30\n");
  const auto stands_at_stop = [&] { return rig.status().wait.reason == WaitReason::program_stop; };
  rig.start();
  ASSERT_TRUE(rig.until(stands_at_stop));
  ASSERT_EQ(window(rig), 0.05);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }));
  EXPECT_EQ(window(rig), kOwn) << "M30";
  for (const RequestKind ends : {RequestKind::stop, RequestKind::reset}) {
    rig.start();
    ASSERT_TRUE(rig.until(stands_at_stop));
    ASSERT_EQ(window(rig), 0.05);
    EXPECT_EQ(rig.ask(ends), cycle::Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::idle; }));
    EXPECT_EQ(window(rig), kOwn);
  }
  rig.start();
  ASSERT_TRUE(rig.until(stands_at_stop));
  rig.drives.fault[1] = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(window(rig), kOwn) << "an alarm";
}

TEST(Window, never_exceeds_the_following_error_that_stops_the_machine) {
  Rig rig("N10 G29\nN20 (DTL,X50)\nN30 M0\nN40 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == WaitReason::program_stop; }));
  EXPECT_EQ(window(rig), rig.cycle->axes()[0].config().following_error_limit)
      << "whatever a program has asked for that nobody has checked";
}

TEST(Window, that_is_left_by_too_much_is_the_limit_that_the_alarm_names) {
  Rig rig("N10 G29\nN20 (DTL,X0.05)\nN30 G1 X20 F600\nN40 M30\n");
  stick_beyond(rig, 19.8);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.alarms(axis::alarm::kInPositionTimeout) == 1; }))
      << rig.alarm_list();
  EXPECT_EQ(rig.alarm(axis::alarm::kInPositionTimeout)->limit, 0.05);
}

}  // namespace
}  // namespace servogate::channel::test
