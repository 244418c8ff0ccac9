// SPDX-License-Identifier: Apache-2.0
// What the PLC hands over from the operator for a whole program: skip levels and dry run.
#include <gtest/gtest.h>

#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

double duration(Rig& rig) {
  const double begun = rig.image().now.seconds();
  EXPECT_TRUE(rig.finish()) << rig.alarm_list();
  return rig.image().now.seconds() - begun;
}

TEST(SkipLevels, bit_0_leaves_out_the_blocks_marked_with_a_slash) {
  for (const int levels : {0, 1, 2}) {
    Rig rig("N10 G1 X10 F6000\n/N20 Y20\nN30 Z5\nN40 M30\n");
    rig.logic.skip_levels = levels;
    rig.run(0.01);
    EXPECT_TRUE(rig.finish()) << rig.alarm_list();
    EXPECT_NEAR(rig.x(1), (levels & 1) != 0 ? 0.0 : 20.0, 1e-9) << levels;
    EXPECT_NEAR(rig.x(2), 5.0, 1e-9) << levels;
  }
}

TEST(SkipLevels, are_taken_over_when_the_program_starts_and_the_programs_own_word_comes_after_them) {
  Rig rig("N10 G4 F1\nN15 G1 X10 F6000\nN20 M0\n/N30 Y20\nN40 M30\n");
  rig.logic.skip_levels = 1;
  rig.run(0.01);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::waiting; })) << rig.alarm_list();
  rig.logic.skip_levels = 0;
  rig.run(0.1);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == image::ProcessState::ended; })) << rig.alarm_list();
  EXPECT_NEAR(rig.x(1), 0.0, 1e-9) << "still skipped";

  rig.load("USB=1\nN10 G1 F6000 X5\n/N20 Y20\nN30 M30\n");
  rig.logic.skip_levels = 1;
  rig.run(0.01);
  EXPECT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_NEAR(rig.x(1), 20.0, 1e-9) << "USB=1 executes them";
}

TEST(DryRun, moves_along_the_same_path_at_rapid_speed_within_the_limits) {
  const char* part = "N10 G1 X100 F600\nN20 G3 X100 Y100 I100 J50\nN30 G1 X0 Y0 F1200\nN40 M30\n";
  Rig slow(part), fast(part);
  const double usual_s = duration(slow);
  fast.logic.dry_run = true;
  fast.run(0.01);
  const double dry_s = duration(fast);
  EXPECT_LT(dry_s, 0.2 * usual_s);
  EXPECT_NEAR(fast.x(), 0.0, 1e-9);
  EXPECT_EQ(fast.violations(), "");
}

TEST(DryRun, is_not_for_typed_blocks) {
  Rig rig("N10 M30\n");
  rig.logic.dry_run = true;
  rig.run(0.01);
  rig.process->set_manual_block("G1 X20 F600");
  ASSERT_EQ(rig.ask(image::RequestKind::mode, static_cast<double>(image::Mode::mdi)), cycle::Refusal::none);
  EXPECT_GT(duration(rig), 1.9);
}

}  // namespace
}  // namespace servogate::channel::test
