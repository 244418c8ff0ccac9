// SPDX-License-Identifier: Apache-2.0
// Warnings of axes in the composed mill: `following_error_warn`, and a homing that was broken off.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/machine_run/rig/mill.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

TEST(FollowingWarning, the_warning_of_a_following_error_names_axis_error_and_limit_and_stops_nothing) {
  Mill mill(changed_mill([](std::string& text) {
              replace(text, "following_error_warn = \"0.5 mm\"", "following_error_warn = \"1 um\"");
              replace(text, "following_error_velocity = \"2 ms\"", "following_error_velocity = 0");
            }),
            "N10 G1 X50 F3000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }, 20.0))
      << mill.alarm_list();
  EXPECT_EQ(mill.alarms(axis::alarm::kFollowingErrorHigh), 1) << mill.alarm_list();
  const image::AlarmRecord warning = mill.control().cycle().alarms().history().front();
  EXPECT_EQ(warning.reaction, image::Reaction::warn);
  const std::string words = image::render(warning, mill.control().alarm_names(), text::Language::english);
  EXPECT_TRUE(words.starts_with("X: following error ")) << words;
  EXPECT_NE(words.find(" mm, warning limit 0.001 mm, at "), std::string::npos) << words;
}

TEST(FollowingWarning, the_mill_as_it_is_has_no_following_error_worth_a_warning) {
  Mill mill("N10 G1 X50 F3000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }, 20.0));
  EXPECT_EQ(mill.alarms(axis::alarm::kFollowingErrorHigh), 0) << mill.alarm_list();
}

bool warns_of_homing(Mill& mill, int axis) {
  return mill.control().cycle().alarms().active(axis::alarm::kHomingInterrupted, axis);
}

/// Asks for the power, without a reset, and begins to home these axes (bits).
bool begin_homing(Mill& mill, double axes) {
  if (mill.ask(RequestKind::power, 1.0) != Refusal::none) return false;
  const auto ready = [&] {
    const auto all = mill.control().cycle().axes();
    return std::all_of(all.begin(), all.end(), [](const axis::Axis& a) { return a.motion_permitted(); });
  };
  return mill.until(ready, 5.0) && mill.ask(RequestKind::home, axes) == Refusal::none;
}

TEST(HomingWarning, of_an_axis_ends_when_that_axis_has_been_homed_and_no_sooner) {
  Mill mill;
  ASSERT_TRUE(mill.power_on()) << mill.alarm_list();
  ASSERT_TRUE(begin_homing(mill, 3.0));
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").moving && mill.axis("Y").moving; }, 5.0));
  ASSERT_EQ(mill.ask(RequestKind::power, 0.0), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return warns_of_homing(mill, 0) && warns_of_homing(mill, 1); }, 5.0));
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 5.0));
  mill.run(1.0);
  ASSERT_TRUE(begin_homing(mill, 1.0));
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").moving; }, 5.0));
  EXPECT_TRUE(warns_of_homing(mill, 0)) << "it homes, and is not homed yet";
  ASSERT_TRUE(mill.until([&] { return !warns_of_homing(mill, 0); }, 60.0)) << mill.alarm_list();
  EXPECT_TRUE(mill.axis("X").homed);
  EXPECT_TRUE(warns_of_homing(mill, 1)) << "Y has not been homed";
  EXPECT_EQ(mill.alarms(axis::alarm::kHomingInterrupted), 2) << "what has been stays in the history";
}

}  // namespace
}  // namespace servogate::machine_run
