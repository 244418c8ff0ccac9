// SPDX-License-Identifier: Apache-2.0
// Feed per revolution: the path follows the spindle, whatever changes its speed.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;

/// mm that the path went in one revolution of the spindle, as both are commanded.
double per_revolution(const Rig& rig) {
  return rig.status().feed_mm_s * 60.0 / std::abs(rig.image().spindles[0].command_rpm);
}

TEST(FeedPerRevolution, is_right_at_each_radius_of_a_face_turned_at_constant_cutting_speed) {
  Rig rig("S100 M3\nG0 X80\nG96 S100\nG95 F0.2\nG1 X10\nG0 X80\nM30\n", "G27", 0.5, RigKind::lathe);
  double least = 1e9, most = 0.0, slowest = 1e9, fastest = 0.0;
  int steady = 0;
  rig.each = [&] {
    const double radius = rig.x(), feed = rig.status().feed_mm_s;
    if (rig.status().line != 5 || radius > 39.5 || radius < 5.5) return;
    EXPECT_NEAR(per_revolution(rig), 0.2, 0.002) << radius;
    if (radius < 8.0) return;  // there the spindle's own ramp is behind
    ++steady;
    // n = 1000 v / (pi D)
    const double rpm = 100.0 * 1000.0 / (2.0 * std::numbers::pi * radius);
    EXPECT_NEAR(rig.image().spindles[0].command_rpm, rpm, rpm * 0.005) << radius;
    least = std::min(least, feed / (0.2 * rpm / 60.0));
    most = std::max(most, feed / (0.2 * rpm / 60.0));
    slowest = std::min(slowest, feed);
    fastest = std::max(fastest, feed);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(steady, 10000);
  EXPECT_GT(least, 0.99);
  EXPECT_LT(most, 1.01);
  EXPECT_NEAR(slowest, 1.343, 0.005);  // mm/s at the radius of 39.5 mm
  EXPECT_NEAR(fastest, 6.631, 0.03);   // at 8 mm
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedPerRevolution, is_right_along_an_arc_and_where_the_spindle_has_reached_its_limit) {
  Rig rig("S100 M3\nG0 X40 Y0\nG96 S400\nG95 F0.1\nG3 X0 Y20 I0 J0\nG0 X40\nM30\n", "G27", 0.5,
          RigKind::lathe);
  int steady = 0;
  rig.each = [&] {
    const image::SpindleImage& spindle = rig.image().spindles[0];
    if (rig.status().line != 5 || rig.x(1) < 1.0 || rig.x(1) > 19.5 || rig.status().feed_mm_s < 1.0) return;
    ++steady;
    EXPECT_NEAR(per_revolution(rig), 0.1, 0.001) << rig.x() << " at " << spindle.command_rpm;
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(steady, 500);
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedPerRevolution, is_right_along_a_contour_of_short_blocks_at_constant_cutting_speed) {
  std::string program = "S100 M3\nG0 X80 Y0\nG96 S100\nG95 F0.2\n";
  for (int k = 1; k <= 150; ++k)
    program += "G1 X" + std::to_string(80 - 0.4 * k) + " Y" + std::to_string(2 * std::sin(0.05 * k)) + "\n";
  Rig rig(program + "G94 G0 X80\nM30\n", "G27", 0.5, RigKind::lathe);
  int steady = 0;
  rig.each = [&] {
    const double radius = rig.x();
    if (rig.status().line < 5 || rig.status().line > 154 || radius > 39.0 || radius < 11.0) return;
    ++steady;
    EXPECT_NEAR(per_revolution(rig), 0.2, 0.002) << radius;
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(steady, 5000);
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedPerRevolution, is_nearly_right_while_the_spindle_slows_down_less_than_its_cutting_speed_asks_for) {
  Rig rig("TMR=2\nS2600 M3\nG0 X12 Y0\nG4\nG96 S100\nG95 F1\nG1 X60\nX62 Y3\nG94 G0 X80\nM30\n", "G27", 0.5,
          RigKind::lathe);
  int late = 0;
  rig.each = [&] {
    const double radius = rig.x(), rpm = rig.image().spindles[0].command_rpm;
    if (rig.status().line != 7 || radius < 9.0 || radius > 29.0) return;
    if (rpm > 1.1 * 100.0 * 1000.0 / (2.0 * std::numbers::pi * radius)) ++late;
    EXPECT_NEAR(per_revolution(rig), 1.0, 0.05) << radius << " at " << rpm << " rpm";
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(late, 400);
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedPerRevolution, follows_the_ramp_and_the_override_of_the_spindle) {
  Rig rig("S600 M3\nG95 F0.5\nG1 X100\nM30\n", "G27", 0.5, RigKind::lathe);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().feed_mm_s > 4.99; }));
  EXPECT_NEAR(rig.status().feed_mm_s, 5.0, 0.01);
  rig.logic.spindle_override = 75;
  for (int n = 0; n < 20; ++n) {
    rig.run(0.05);
    EXPECT_NEAR(per_revolution(rig), 0.5, 0.01) << rig.image().spindles[0].command_rpm;
  }
  EXPECT_NEAR(rig.status().feed_mm_s, 3.75, 0.01);
  rig.logic.spindle_override = 120;
  rig.run(1.0);
  EXPECT_NEAR(rig.status().feed_mm_s, 6.0, 0.01);
  ASSERT_EQ(rig.ask(RequestKind::override_feed, 0.5), cycle::Refusal::none);
  rig.run(0.5);
  EXPECT_NEAR(rig.status().feed_mm_s, 3.0, 0.01);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedPerRevolution, rests_on_the_path_while_the_spindle_stands_and_goes_on_with_it) {
  Rig rig("S600 M3\nG95 F0.5\nG1 X100\nG94 F6000\nX0\nM30\n", "G27", 0.5, RigKind::lathe);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 10.0; }));
  rig.logic.spindle_enable = false;
  ASSERT_TRUE(rig.until([&] { return !rig.moving(); }, 5.0));
  const double stood = rig.x();
  rig.run(0.5);
  EXPECT_EQ(rig.x(), stood);
  EXPECT_EQ(rig.state(), ProcessState::running);
  EXPECT_EQ(rig.status().wait.reason, image::WaitReason::spindle_stands);
  rig.logic.spindle_enable = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_EQ(rig.alarm_list(), "");
  EXPECT_EQ(rig.violations(), "");
}

TEST(FeedPerRevolution, takes_the_speed_to_which_the_spindle_limits_what_is_programmed) {
  Rig rig("S9000 M3\nG95 F0.1\nG1 X100\nM30\n", "G27", 0.5, RigKind::lathe);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 20.0; }));
  EXPECT_NEAR(rig.status().feed_mm_s, 0.1 * kSpindleMax / 60.0, 0.01);
  EXPECT_EQ(rig.alarms(cycle::alarm::kProgramWarning), 1) << rig.alarm_list();
}

TEST(Feed, is_that_of_the_vector_over_millimetres_and_degrees_alike) {
  // T-ROT-02: X 30 with B 90, F436.79 in mm/min, 4.6041 in 1/min: both 13.032 s.
  for (const char* program : {"G94 G1 X30 B90 F436.79\nM30\n", "G93 G1 X30 B90 F4.6041\nM30\n"}) {
    Rig rig(program, "G29", 0.5, RigKind::rotary);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.status().feed_mm_s > 0.0; })) << program;
    const double began = rig.now();
    ASSERT_TRUE(rig.until([&] { return rig.status().feed_mm_s == 0.0; })) << program;
    EXPECT_NEAR(rig.now() - began, 13.032, 0.15) << program;
    EXPECT_NEAR(rig.x(1), 90.0, 1e-6) << program;
  }
}

TEST(Warning, is_one_alarm_a_place_and_leaves_the_path_as_it_is) {
  const auto run = [](const char* program) {
    Rig rig(program, "G27", 0.5, RigKind::lathe);
    EXPECT_TRUE(rig.finish()) << rig.alarm_list();
    EXPECT_EQ(rig.violations(), "");
    return std::pair(rig.path.size(), rig.alarms(cycle::alarm::kProgramWarning));
  };
  // The feed of 90000 mm/min is beyond the axes' 30000, which is as fast as 30000 itself.
  const auto [plain, none] = run("G1 X20 F30000\nX30\nX60\nX20\nX100\nM30\n");
  const auto [told, warnings] = run("G1 X20 F90000\nX30\nX60\nX20\nX100\nM30\n");
  EXPECT_EQ(none, 0);
  EXPECT_EQ(warnings, 1);
  EXPECT_EQ(plain, told);
}

TEST(Warning, names_the_block_where_the_path_rests_unasked_and_the_program_comes_to_its_end) {
  std::string program = "G1 F3600\n";
  for (int k = 1; k <= 200; ++k) program += "X" + std::to_string(0.3 * k) + "\n";
  program += "F12000\n";
  for (int k = 1; k <= 200; ++k)
    program += "X" + std::to_string(60 + 6 * std::sin(k * 0.05)) + " Y" +
               std::to_string(6 - 6 * std::cos(k * 0.05)) + "\n";
  Rig rig(program + "M30\n", "G27", 0.5, RigKind::lawless);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
  EXPECT_NEAR(rig.x(), 60 + 6 * std::sin(10.0), 1e-4);
  const image::AlarmRecord* warning = rig.alarm(cycle::alarm::kProgramWarning);
  ASSERT_NE(warning, nullptr) << rig.alarm_list();
  EXPECT_GT(warning->line, 100);
  const auto found = rig.process->feeder().texts().finding(static_cast<std::int32_t>(warning->value));
  ASSERT_TRUE(found);
  EXPECT_NE(found->str(text::Language::english).find("warning: the path comes to rest inside this block"),
            std::string::npos)
      << found->str(text::Language::english);
}

TEST(Warning, names_line_and_finding_and_each_speed_once_however_often_it_is_asked_for) {
  Rig rig("N10 S9000 M3\nN20 S9500\nN30 S9000\nM30\n", "G27", 0.5, RigKind::lathe);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  const auto history = rig.cycle->alarms().history();
  ASSERT_EQ(history.size(), 2u) << rig.alarm_list();
  EXPECT_EQ(history[0].line, 1);
  EXPECT_EQ(history[1].line, 2);
  for (const image::AlarmRecord& r : history) EXPECT_EQ(r.reaction, image::Reaction::warn);
  const auto found = rig.process->feeder().texts().finding(static_cast<std::int32_t>(history[1].value));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->str(text::Language::english),
            "test.nc:2:5: warning: S9500 is above the 4000 rpm of the spindle: it turns at 4000 [P808]");
}

}  // namespace
}  // namespace servogate::channel::test
