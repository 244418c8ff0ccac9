// SPDX-License-Identifier: Apache-2.0
// Work beside a held program: axes leave the path and come back by the way that they went, functions are
// typed, and the program goes on only where and as it was held.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/channel/motion/way_back.hpp"
#include "tests/channel/rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::channel::test {
namespace {

using cycle::Refusal;
using image::Function;
using image::ProcessState;
using image::RequestKind;

constexpr const char* kCut = "N10 S1000 M3\nN20 G1 X200 Y100 F9000\nN30 X0 Y100\nN40 M30\n";

class Beside : public ::testing::Test {
 protected:
  /// Held in the middle of the slanted line.
  static void hold(Rig& rig) {
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x() > 20.0; }));
    ASSERT_EQ(rig.ask(RequestKind::hold), Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held && !rig.moving(); }, 1.0));
    rig.run(0.01);
  }
  static void jog(Rig& rig, int axis, double way) {
    ASSERT_EQ(rig.ask(RequestKind::jog_increment, way, axis), Refusal::none);
    stand(rig);
  }
  static void stand(Rig& rig) {
    ASSERT_TRUE(rig.until([&] { return !rig.moving(); }, 5.0));
    rig.run(0.01);
  }
  static Refusal function(Rig& rig, Function what, double value = 0.0) {
    image::Request r;
    r.kind = RequestKind::function;
    r.index = static_cast<std::uint32_t>(what);
    r.value = value;
    return rig.ask(r);
  }
  static double beside(const Rig& rig, int axis) {
    return rig.image().axes[static_cast<std::size_t>(axis)].beside;
  }
};

TEST_F(Beside, axes_return_by_the_way_that_they_went_and_the_program_goes_on_on_its_path) {
  Rig rig(kCut);
  hold(rig);
  const double x = rig.x(), y = rig.x(1);
  jog(rig, 2, 10.0);
  jog(rig, 0, -5.0);
  jog(rig, 1, 7.0);
  EXPECT_NEAR(beside(rig, 0), -5.0, 1e-9);
  EXPECT_NEAR(beside(rig, 1), 7.0, 1e-9);
  EXPECT_NEAR(beside(rig, 2), 10.0, 1e-9);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::off_path);
  EXPECT_EQ(rig.ask(RequestKind::start), Refusal::off_path) << "the start button, too";
  const std::size_t from = rig.path.size();
  ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 2), Refusal::axis_moves) << "on the way back";
  ASSERT_TRUE(rig.until([&] { return beside(rig, 2) == 0.0 && !rig.moving(); }, 5.0));
  rig.run(0.01);
  // Y first, then X, the depth last.
  for (std::size_t i = from + 1; i < rig.path.size(); ++i) {
    const auto &a = rig.path[i - 1], &b = rig.path[i];
    const int moved = static_cast<int>(std::abs(a[0] - b[0]) > 1e-9) + (std::abs(a[1] - b[1]) > 1e-9) +
                      (std::abs(a[2] - b[2]) > 1e-9);
    ASSERT_LE(moved, 1) << "one axis at a time";
    if (std::abs(b[2] - a[2]) > 1e-9) {
      ASSERT_NEAR(b[0], x, 1e-9);
      ASSERT_NEAR(b[1], y, 1e-9);
    }
    if (std::abs(b[0] - a[0]) > 1e-9) {
      ASSERT_NEAR(b[1], y, 1e-9);
    }
  }
  EXPECT_NEAR(rig.x(), x, 1e-9);
  EXPECT_NEAR(rig.x(2), 0.0, 1e-9);
  EXPECT_EQ(rig.ask(RequestKind::reposition), Refusal::on_path);
  const std::size_t resumed = rig.path.size();
  ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  for (std::size_t i = resumed; i < rig.path.size(); ++i) {
    const double off =
        std::min(off_line(rig.path[i], 0, 0, 200, 100), off_line(rig.path[i], 200, 100, 0, 100));
    ASSERT_LT(off, 0.01 + 1e-6);
  }
  EXPECT_NEAR(rig.x(), 0.0, 1e-9);
  EXPECT_NEAR(rig.x(1), 100.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(Beside, one_axis_moves_at_a_time) {
  Rig rig(kCut);
  hold(rig);
  ASSERT_EQ(rig.ask(RequestKind::jog_increment, 50.0, 2), Refusal::none);
  rig.run(0.1);
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 0), Refusal::axis_moves);
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 2), Refusal::none) << "the same axis goes on";
  stand(rig);
  EXPECT_NEAR(beside(rig, 2), 51.0, 1e-9);
}

TEST_F(Beside, an_axis_that_is_jogged_back_by_hand_is_on_the_path_again) {
  Rig rig(kCut);
  hold(rig);
  jog(rig, 2, 10.0);
  jog(rig, 2, -10.0);
  ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
}

TEST_F(Beside, a_stop_on_the_way_back_keeps_what_is_left_of_it) {
  for (const RequestKind stop : {RequestKind::jog_stop, RequestKind::hold}) {
    Rig rig(kCut);
    hold(rig);
    jog(rig, 2, 60.0);
    ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
    rig.run(0.2);
    ASSERT_EQ(rig.ask(stop), Refusal::none);
    stand(rig);
    rig.run(0.5);
    EXPECT_FALSE(rig.moving());
    EXPECT_GT(beside(rig, 2), 1.0);
    EXPECT_EQ(rig.state(), ProcessState::held);
    EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::off_path);
    ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
    ASSERT_TRUE(rig.until([&] { return beside(rig, 2) == 0.0 && !rig.moving(); }, 5.0));
    rig.run(0.01);
    rig.run(0.01);
    EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::none);
  }
}

TEST_F(Beside, the_feed_of_the_way_back_is_kept) {
  Rig rig(kCut);
  hold(rig);
  jog(rig, 2, 10.0);
  image::Request r;
  r.kind = RequestKind::reposition;
  r.velocity = 5.0;
  double fastest = 0.0;
  rig.each = [&] { fastest = std::max(fastest, std::abs(rig.image().axes[2].command_velocity)); };
  ASSERT_EQ(rig.ask(r), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return beside(rig, 2) == 0.0 && !rig.moving(); }, 10.0));
  EXPECT_NEAR(fastest, 5.0, 1e-6);
}

TEST_F(Beside, nothing_is_possible_while_the_program_runs_or_a_door_holds_it) {
  Rig rig(kCut);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 20.0; }));
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 2), Refusal::program_runs);
  EXPECT_EQ(function(rig, Function::m, 9), Refusal::program_not_held);
  EXPECT_EQ(rig.ask(RequestKind::reposition), Refusal::program_not_held);
  rig.logic.feed_enable = false;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held; }, 1.0));
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 2), Refusal::program_runs)
      << "it goes on by itself when the door closes";
}

TEST_F(Beside, a_program_stays_where_it_is_whatever_the_plc_permits_meanwhile) {
  Rig rig(kCut);
  hold(rig);
  const double x = rig.x();
  jog(rig, 2, 10.0);
  rig.logic.start_bit = true;
  rig.run(0.2);
  rig.logic.feed_enable = false;
  rig.run(0.2);
  rig.logic.feed_enable = true;
  rig.run(0.2);
  EXPECT_EQ(rig.x(), x);
  EXPECT_EQ(rig.state(), ProcessState::held);
}

TEST_F(Beside, a_reset_or_an_emergency_stop_ends_the_program_and_moves_nothing_back) {
  for (const bool emergency : {false, true}) {
    Rig rig(kCut);
    hold(rig);
    jog(rig, 2, 10.0);
    const double x = rig.x();
    if (emergency)
      rig.logic.estop_ok = false;
    else
      rig.ask(RequestKind::reset);
    rig.run(1.0);
    EXPECT_NE(rig.state(), ProcessState::held);
    EXPECT_NEAR(rig.x(2), 10.0, 0.01);
    EXPECT_NEAR(rig.x(), x, 0.01);
    EXPECT_NE(rig.ask(RequestKind::reposition), Refusal::none);
    EXPECT_EQ(beside(rig, 2), 0.0);
  }
}

TEST_F(Beside, functions_reach_the_plc_and_the_program_waits_until_the_spindle_turns_again) {
  Rig rig(kCut);
  hold(rig);
  rig.logic.strobes.clear();
  ASSERT_EQ(function(rig, Function::spindle_stop), Refusal::none);
  ASSERT_EQ(function(rig, Function::m, 9), Refusal::none) << "one behind the other";
  rig.run(0.2);
  ASSERT_EQ(rig.logic.strobes.size(), 1u);
  EXPECT_EQ(rig.logic.strobes[0].code, 9);
  ASSERT_TRUE(rig.until([&] { return rig.image().spindles[0].command_rpm == 0.0; }, 5.0));
  EXPECT_EQ(rig.state(), ProcessState::held);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::spindle_differs);
  ASSERT_EQ(function(rig, Function::spindle_clockwise, 800.0), Refusal::none);
  rig.run(0.2);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::spindle_differs) << "another speed";
  ASSERT_EQ(function(rig, Function::spindle_clockwise, 1000.0), Refusal::none);
  rig.run(0.2);
  ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
}

TEST_F(Beside, a_program_is_not_resumed_in_any_cycle_of_a_function_nor_from_beside_its_path) {
  for (const bool away : {false, true}) {
    Rig rig(kCut);
    hold(rig);
    if (away) jog(rig, 2, 10.0);
    rig.logic.delay_cycles = 40;
    ASSERT_EQ(function(rig, Function::m, 8), Refusal::none);
    ASSERT_EQ(function(rig, Function::spindle_clockwise, 700.0), Refusal::none);
    const double x = rig.x();
    const std::size_t functions = rig.logic.strobes.size();
    for (const RequestKind on : {RequestKind::resume, RequestKind::start})
      for (int cycle = 0; cycle < 60; ++cycle) EXPECT_NE(rig.ask(on), Refusal::none) << cycle;
    EXPECT_GT(rig.logic.strobes.size(), functions);
    rig.run(1.0);
    EXPECT_EQ(rig.ask(RequestKind::resume), away ? Refusal::off_path : Refusal::spindle_differs);
    EXPECT_EQ(rig.x(), x);
    ASSERT_EQ(function(rig, Function::spindle_clockwise, 1000.0), Refusal::none);
    rig.run(1.0);
    if (away) {
      EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::off_path);
      ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
      stand(rig);
    }
    ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  }
}

TEST_F(Beside, another_tool_in_the_spindle_keeps_the_program_from_going_on) {
  Rig rig("N5 T3.3 M6\nN10 G1 X200 Y100 F9000\nN40 M30\n");
  hold(rig);
  ASSERT_EQ(function(rig, Function::tool, 4), Refusal::none);
  ASSERT_EQ(function(rig, Function::m, 6), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.status().tool == 4; }, 2.0));
  rig.run(0.2);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::tool_differs);
  ASSERT_EQ(function(rig, Function::tool, 3), Refusal::none);
  rig.run(0.2);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::none);
}

TEST_F(Beside, functions_are_refused_one_by_one_when_too_many_wait) {
  Rig rig(kCut);
  rig.logic.delay_cycles = 50;
  hold(rig);
  int taken = 0;
  while (taken < 20 && function(rig, Function::m, 8) == Refusal::none) ++taken;
  EXPECT_LT(taken, 20);
  EXPECT_GE(taken, 8);
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 2), Refusal::function_runs);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::function_runs);
  rig.run(3.0);
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::none);
}

TEST_F(Beside, a_programmed_stop_permits_the_same_and_goes_on_by_start) {
  Rig rig("N10 G1 X20 F3000\nN20 M0\nN30 X40\nN40 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == image::WaitReason::program_stop; }, 5.0));
  jog(rig, 2, 5.0);
  ASSERT_EQ(function(rig, Function::m, 8), Refusal::none);
  rig.run(0.2);
  EXPECT_EQ(rig.status().wait.reason, image::WaitReason::program_stop) << "M0 still waits";
  EXPECT_EQ(rig.ask(RequestKind::start), Refusal::off_path);
  ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return beside(rig, 2) == 0.0 && !rig.moving(); }, 5.0));
  rig.run(0.01);
  EXPECT_EQ(rig.x(), 20.0);
  ASSERT_EQ(rig.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 40.0, 1e-9);
}

TEST_F(Beside, random_work_beside_the_path_comes_back_to_it) {
  std::mt19937 random(static_cast<unsigned>(servogate::test::property_seed()));
  for (int round = 0; round < 20; ++round) {
    Rig rig(kCut);
    hold(rig);
    const std::array<double, kAxes> place = rig.path.back();
    std::uniform_int_distribution<int> axis(0, kAxes - 1);
    std::uniform_real_distribution<double> way(-30.0, 30.0);
    for (int n = 0; n < 12; ++n) jog(rig, axis(random), way(random));
    ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
    ASSERT_TRUE(
        rig.until([&] { return !rig.moving() && rig.ask(RequestKind::resume) == Refusal::none; }, 60.0));
    const std::array<double, kAxes> back = rig.path.back();
    for (std::size_t a = 0; a < back.size(); ++a) EXPECT_NEAR(back[a], place[a], 0.05) << round;
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(WayBack, holds_as_many_legs_as_it_says) {
  WayBack way;
  for (std::size_t n = 0; n < WayBack::kMostLegs; ++n) {
    EXPECT_FALSE(way.full());
    way.leave(static_cast<int>(n % 2), static_cast<double>(n));
  }
  EXPECT_TRUE(way.full());
  way.leave(way.axis(), 1e9);
  EXPECT_EQ(way.from(), static_cast<double>(WayBack::kMostLegs - 1)) << "the same leg goes on";
}

}  // namespace
}  // namespace servogate::channel::test
