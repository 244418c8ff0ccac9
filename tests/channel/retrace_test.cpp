// SPDX-License-Identifier: Apache-2.0
// Along the path of a held program: back, and forward again to where it was held.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using cycle::Refusal;
using image::ProcessState;
using image::RequestKind;

using Point = std::array<double, kAxes>;

double apart(const Point& a, const Point& b) {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                   (a[2] - b[2]) * (a[2] - b[2]));
}

class Retrace : public ::testing::Test {
 protected:
  static Point here(const Rig& rig) { return {rig.x(0), rig.x(1), rig.x(2)}; }
  static void hold(Rig& rig) {
    ASSERT_EQ(rig.ask(RequestKind::hold), Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held && !rig.moving(); }, 3.0));
    rig.run(0.02);
  }
  /// The program of kShapes is held in the line behind its corner.
  static void hold_behind_the_arc(Rig& rig) {
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x(1) > 20.0 && rig.x() > 59.0; }));
    hold(rig);
  }
  static void go_on_to_the_end(Rig& rig, double patience_s = 30.0) {
    ASSERT_EQ(rig.ask(RequestKind::resume), Refusal::none);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; }, patience_s))
        << rig.alarm_list();
  }
  static Refusal ask(Rig& rig, double mm, std::uint32_t blocks = 0) {
    image::Request r;
    r.kind = RequestKind::retrace;
    r.value = mm;
    r.index = blocks;
    return rig.ask(r);
  }
  static void stand(Rig& rig) {
    ASSERT_TRUE(rig.until([&] { return !rig.status().retracing && !rig.moving(); }, 60.0));
    rig.run(0.02);
  }
  static void back(Rig& rig, double mm, std::uint32_t blocks = 0) {
    ASSERT_EQ(ask(rig, mm, blocks), Refusal::none);
    stand(rig);
  }
  static void forward(Rig& rig) {
    ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
    stand(rig);
  }
  /// No place from a cycle on is further than that from the path that was driven before it.
  static void expect_on_path(const Rig& rig, std::size_t begin, double tolerance) {
    double most = 0.0;
    for (std::size_t i = begin; i < rig.path.size(); i += 7) {
      double least = 1e9;
      for (std::size_t k = 1; k < begin; ++k) least = std::min(least, apart(rig.path[i], rig.path[k]));
      most = std::max(most, least);
    }
    EXPECT_LE(most, tolerance);
  }
};

constexpr const char* kShapes =
    "N10 S1000 M3\nN20 G1 X20 Y10 F3000\nN30 G2 X40 Y10 I30 J10\nN40 G1 X60 Y10\nN50 X60 Y40\nN60 X0 "
    "Y40\nN70 "
    "M30\n";

TEST_F(Retrace, goes_back_along_lines_and_arcs_and_forward_again_to_where_the_program_was_held) {
  Rig rig(kShapes);
  hold_behind_the_arc(rig);
  const Point held = here(rig);
  const std::size_t begin = rig.path.size();
  back(rig, 50.0);
  EXPECT_TRUE(rig.status().retraced);
  EXPECT_NEAR(rig.status().retraced_mm, 50.0, 0.01);
  EXPECT_EQ(rig.status().line, 3) << "in the arc";
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::retraced);
  EXPECT_EQ(rig.ask(RequestKind::start), Refusal::retraced) << "the start button, too";
  forward(rig);
  EXPECT_FALSE(rig.status().retraced);
  EXPECT_EQ(rig.status().line, 5);
  EXPECT_LE(apart(here(rig), held), 1e-9);
  expect_on_path(rig, begin, 0.06);  // places of two cycles are so far apart
  go_on_to_the_end(rig);
  EXPECT_NEAR(rig.x(), 0.0, 1e-9);
  EXPECT_NEAR(rig.x(1), 40.0, 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(Retrace, goes_back_to_the_begin_of_so_many_blocks_and_further_from_there) {
  Rig rig(kShapes);
  hold_behind_the_arc(rig);
  const Point held = here(rig);
  back(rig, 0.0, 1);
  EXPECT_LE(apart(here(rig), {60, 10, 0}), 1e-6);
  back(rig, 0.0, 1);
  EXPECT_LE(apart(here(rig), {40, 10, 0}), 1e-6);
  back(rig, 0.0, 5);
  EXPECT_LE(apart(here(rig), {0, 0, 0}), 1e-6) << "no further than the spindle's word";
  EXPECT_EQ(rig.ask(RequestKind::resume), Refusal::retraced);
  forward(rig);
  EXPECT_LE(apart(here(rig), held), 1e-9);
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(Retrace, does_not_lead_over_a_tool_or_a_function) {
  Rig rig("N10 G1 X30 F3000\nN20 M8\nN30 X60\nN40 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 40.0; }));
  hold(rig);
  back(rig, 100.0);
  EXPECT_NEAR(rig.x(), 30.0, 1e-9);
  back(rig, 100.0);
  EXPECT_NEAR(rig.x(), 30.0, 1e-9) << "there is nothing behind";
  forward(rig);
  go_on_to_the_end(rig);
}

TEST_F(Retrace, ends_at_a_hold_where_it_is_and_goes_on_from_there_both_ways) {
  Rig rig(kShapes);
  hold_behind_the_arc(rig);
  const Point held = here(rig);
  const std::size_t begin = rig.path.size();
  ASSERT_EQ(ask(rig, 60.0), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.x() < 40.5; }));  // into the arc
  EXPECT_EQ(ask(rig, 1.0), Refusal::axis_moves) << "it is on its way";
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 1.0, 2), Refusal::axis_moves);
  hold(rig);
  const double behind = rig.status().retraced_mm;
  EXPECT_GT(behind, 20.0);
  EXPECT_LT(behind, 59.0);
  back(rig, 5.0);
  EXPECT_NEAR(rig.status().retraced_mm, behind + 5.0, 0.05);
  ASSERT_EQ(rig.ask(RequestKind::reposition), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.x() > 50.0; }));
  hold(rig);
  EXPECT_TRUE(rig.status().retraced);
  forward(rig);
  EXPECT_LE(apart(here(rig), held), 1e-9);
  expect_on_path(rig, begin, 0.06);
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(Retrace, lets_its_axes_be_jogged_away_and_return_leads_them_the_whole_way) {
  Rig rig(kShapes);
  hold_behind_the_arc(rig);
  const Point held = here(rig);
  const auto beside = [&rig](std::size_t axis) { return rig.image().axes[axis].beside; };
  back(rig, 30.0);
  EXPECT_EQ(beside(0), 0.0) << "back on the path is not away from it";
  EXPECT_EQ(beside(1), 0.0);
  ASSERT_EQ(rig.ask(RequestKind::jog_increment, 10.0, 2), Refusal::none);
  stand(rig);
  EXPECT_NEAR(beside(2), 10.0, 1e-9);
  EXPECT_EQ(ask(rig, 1.0), Refusal::off_path);
  forward(rig);
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(beside(axis), 0.0, 1e-9);
  EXPECT_LE(apart(here(rig), held), 1e-9);
  go_on_to_the_end(rig);
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(Retrace, of_a_thousand_short_blocks_comes_to_where_they_began_and_back) {
  std::string program = "G1 X1 F1200\n";
  const auto number = [](double v) { return std::to_string(v); };
  for (int n = 1; n <= 1200; ++n)
    program += "X" + number(1 + 10 * std::sin(n * 0.02)) + " Y" + number(10 - 10 * std::cos(n * 0.02)) + "\n";
  Rig rig(program + "M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().line > 1100; }, 60.0));
  hold(rig);
  const Point held = here(rig);
  const std::int32_t line = rig.status().line;
  const std::size_t begin = rig.path.size();
  back(rig, 0.0, 1050);
  EXPECT_EQ(rig.status().line, line - 1049);
  EXPECT_GT(rig.status().retraced_mm, 200.0);
  expect_on_path(rig, begin, 0.05);
  forward(rig);
  EXPECT_LE(apart(here(rig), held), 1e-9);
  go_on_to_the_end(rig, 60.0);
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(Retrace, is_no_faster_than_asked_for_whatever_override_and_spindle_are) {
  Rig rig("N10 S1000 M3\nN20 G0 X5\nN30 G95 G1 X100 F0.2\nN40 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 20.0; }));
  hold(rig);
  ASSERT_EQ(rig.ask(RequestKind::override_feed, 1.5), Refusal::none);
  image::Request r;
  r.kind = RequestKind::retrace;
  r.value = 8.0;
  r.velocity = 1.0;
  const std::size_t begin = rig.path.size();
  ASSERT_EQ(rig.ask(r), Refusal::none);
  stand(rig);
  double most = 0.0;
  for (std::size_t n = begin + 1; n < rig.path.size(); ++n)
    most = std::max(most, apart(rig.path[n], rig.path[n - 1]) * 1000.0);
  EXPECT_NEAR(most, 1.0, 0.002);
  EXPECT_NEAR(rig.status().retraced_mm, 8.0, 0.01);
}

TEST_F(Retrace, is_refused_while_a_program_runs_and_without_saying_how_far) {
  Rig rig(kShapes);
  EXPECT_EQ(ask(rig, 5.0), Refusal::program_does_not_run);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 30.0; }));
  EXPECT_EQ(ask(rig, 5.0), Refusal::program_not_held);
  hold(rig);
  EXPECT_EQ(ask(rig, 0.0), Refusal::bad_value);
  EXPECT_EQ(ask(rig, -3.0), Refusal::bad_value);
}

TEST_F(Retrace, rests_while_the_feed_is_not_enabled_and_ends_with_the_program) {
  Rig rig(kShapes);
  hold_behind_the_arc(rig);
  ASSERT_EQ(ask(rig, 60.0), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.x() < 55.0; }));
  rig.logic.feed_enable = false;
  ASSERT_TRUE(rig.until([&] { return !rig.moving(); }, 1.0));
  const Point there = here(rig);
  rig.run(0.3);
  EXPECT_EQ(here(rig), there);
  EXPECT_TRUE(rig.status().retracing);
  rig.logic.feed_enable = true;
  ASSERT_TRUE(rig.until([&] { return rig.x() < 50.0; }));
  ASSERT_EQ(rig.ask(RequestKind::reset), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::idle && !rig.moving(); }, 2.0));
  EXPECT_FALSE(rig.status().retraced);
  EXPECT_EQ(rig.violations(), "");
  rig.run(0.1);
  rig.start();
  EXPECT_EQ(rig.started(), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
}

TEST_F(Retrace, stops_with_an_alarm_and_the_program_ends) {
  Rig rig(kShapes);
  hold_behind_the_arc(rig);
  ASSERT_EQ(ask(rig, 60.0), Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.x() < 55.0; }));
  rig.logic.estop_ok = false;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 2.0));
  EXPECT_FALSE(rig.moving());
  EXPECT_FALSE(rig.status().retraced);
}

}  // namespace
}  // namespace servogate::channel::test
