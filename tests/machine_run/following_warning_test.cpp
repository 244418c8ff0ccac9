// SPDX-License-Identifier: Apache-2.0
// `following_error_warn` in the composed mill.
#include <gtest/gtest.h>

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
  const std::string words = cycle::render(warning, mill.control().alarm_names(), text::Language::english);
  EXPECT_TRUE(words.starts_with("X: following error ")) << words;
  EXPECT_NE(words.find(" mm, a warning from 0.001 mm, at "), std::string::npos) << words;
}

TEST(FollowingWarning, the_mill_as_it_is_has_no_following_error_worth_a_warning) {
  Mill mill("N10 G1 X50 F3000\nN20 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }, 20.0));
  EXPECT_EQ(mill.alarms(axis::alarm::kFollowingErrorHigh), 0) << mill.alarm_list();
}

}  // namespace
}  // namespace servogate::machine_run
