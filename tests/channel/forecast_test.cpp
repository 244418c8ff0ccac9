// SPDX-License-Identifier: Apache-2.0
// How long a program's motion takes, and what of it cannot be driven. Axes without inertia show the feeds as
// they are.
#include "kernel/channel/motion/forecast.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "kernel/program/check/check.hpp"

namespace servogate::channel::test {
namespace {

struct Machine {
  program::MachineModel model;
  path::Config path;
  AxisMap axes;
};

Machine machine(double acceleration = 1e9, double jerk = 1e14, std::string_view letters = "XYZ") {
  Machine m;
  for (const char letter : letters) {
    m.axes.machine.push_back(static_cast<int>(m.model.axes.size()));
    m.path.limits[m.model.axes.size()] = {500.0, acceleration, jerk};
    m.path.rotary[m.model.axes.size()] = letter < 'U';
    m.model.axes.push_back({std::string(1, letter), letter < 'U', false, false, -1e6, 1e6, 500.0});
  }
  m.path.axis_count = static_cast<int>(letters.size());
  m.path.period_s = 1e-6;
  m.model.power_on = {"G94", "G97", "G90", "G71", "G29"};
  return m;
}

double seconds(const std::string& text, const Machine& m = machine()) {
  Forecast forecast(Forecast::Depth::timed, m.path, m.axes, {});
  const program::CheckReport report =
      program::check_program("nc110", m.model, {}, "p.nc", text, {}, {},
                             [&](const program::Command& c) { return forecast.take(c); });
  for (const text::Finding& f : report.findings)
    if (f.severity == text::Severity::error) ADD_FAILURE() << f.str(text::Language::english);
  return forecast.motion_seconds();
}

TEST(Forecast, of_axes_without_inertia_is_the_way_over_the_feed) {
  // T-LIN-01: rapids X 10000, Y 5000 mm/min; T-LIN-02; T-ARC-01; T-FED-01; T-FED-03.
  Machine m = machine();
  m.path.limits[0].velocity = 10000.0 / 60.0;
  m.path.limits[1].velocity = 5000.0 / 60.0;
  EXPECT_NEAR(1.2, seconds("G0 X100 Y100", m), 1e-3);
  EXPECT_NEAR(25.632, seconds("G1 X80 Y30 F200"), 1e-3);
  EXPECT_NEAR(9.4248 + 0.06, seconds("G0 X30\nG3 X0 Y30 I0 J0 F300"), 1e-3);
  EXPECT_NEAR(15.0, seconds("G93 G1 X50 F4"), 1e-3);
  EXPECT_NEAR(60.0, seconds("G95 F0.2\nS500 M3\nG1 X100"), 1e-3);
}

TEST(Forecast, drives_a_quarter_circle_in_the_planes_that_a_machine_of_two_or_five_axes_has) {
  const double quarter = 9.4248;
  const auto arc = [](const char* letters, const std::string& text) {
    return seconds(text, machine(1e9, 1e14, letters));
  };
  EXPECT_NEAR(quarter + 0.06, arc("XZ", "G18\nG0 Z30\nG3 Z0 X30 I0 J0 F300"), 1e-3);
  EXPECT_NEAR(quarter + 0.06, arc("ZX", "G18\nG0 Z30\nG3 Z0 X30 I0 J0 F300"), 1e-3);
  EXPECT_NEAR(quarter + 0.06, arc("XYZAC", "G19\nG0 Y30\nG3 Y0 Z30 I0 J0 F300"), 1e-3);
  EXPECT_NEAR(quarter + 0.06, arc("ACXYZ", "G17\nG0 X30\nG3 X0 Y30 I0 J0 F300"), 1e-3);
  EXPECT_NEAR(quarter + 0.06, arc("UV", "(DPI,U,V)\nG0 U30\nG3 U0 V30 I0 J0 F300"), 1e-3);
}

TEST(Forecast, takes_a_cutting_speed_at_half_of_the_way) {
  // T-SPN-01: 120 m/min at diameter 40 are 954.93 rpm; a face from 40 to 20 is turned at the mean of both.
  Machine m = machine();
  m.model.axes[0].diameter = true;
  m.axes.surface_speed_axis = 0;
  const double there = seconds("G0 X40", m);
  EXPECT_NEAR(there + 60.0 * 10.0 / (0.1 * 954.93), seconds("G95 G96 F0.1\nS120 M3\nG0 X40\nG1 Z10", m),
              0.01);
  EXPECT_NEAR(there + 60.0 * 10.0 / (0.1 * 954.93 * 40.0 / 30.0),
              seconds("G95 G96 F0.1\nS120 M3\nG0 X40\nG1 X20", m), 0.01);
}

TEST(Forecast, forms_the_vector_over_millimetres_and_degrees_alike) {
  // T-ROT-02: X 30 with B 90 on a diameter of 40, wanted speed 200 mm/min.
  Machine m = machine();
  m.model.axes[1] = {"B", true, false, false, -1e6, 1e6, 500.0};
  m.path.rotary[1] = true;
  EXPECT_NEAR(13.032, seconds("G1 X30 B90 F436.79", m), 1e-3);
  EXPECT_NEAR(13.032, seconds("G93 G1 X30 B90 F4.6041", m), 1e-3);
}

TEST(Forecast, counts_ramps_and_a_rest_for_each_function) {
  // 100 mm at 1000 mm/s2 and 10 000 mm/s3 peak at 270.2 mm/s: 2 (0.2702 + 0.1) s.
  const Machine m = machine(1000.0, 10000.0);
  EXPECT_NEAR(0.7403, seconds("G0 X100", m), 1e-3);
  const double through = seconds("G28 G1 X50 F6000\nX100", m);
  EXPECT_GT(seconds("G28 G1 X50 F6000\nM8\nX100", m), through + 0.1);
}

TEST(Forecast, says_what_cannot_be_driven_whether_it_is_timed_or_not) {
  const Machine m = machine();
  for (const Forecast::Depth depth : {Forecast::Depth::drivable, Forecast::Depth::timed}) {
    Forecast forecast(depth, m.path, m.axes, {});
    program::Command command;
    program::Line line;
    line.to[0] = 10.0;
    command.what = line;
    const auto finding = forecast.take(command);
    ASSERT_TRUE(finding);
    EXPECT_EQ("channel.cannot-drive", finding->entry->id);
    EXPECT_NE(std::string::npos, finding->str(text::Language::english).find("program F"));
    EXPECT_NE(std::string::npos, finding->str(text::Language::russian).find("задайте F"));
    command.what = program::Thread{};
    ASSERT_TRUE(forecast.take(command));
  }
}

TEST(Forecast, goes_on_where_an_element_that_cannot_be_driven_would_have_ended) {
  const Machine m = machine();
  for (const Forecast::Depth depth : {Forecast::Depth::drivable, Forecast::Depth::timed}) {
    Forecast forecast(depth, m.path, m.axes, {});
    const auto take = [&](auto what) {
      program::Command command;
      command.what = what;
      return forecast.take(command);
    };
    program::Line line;
    line.to[0] = 10.0;
    EXPECT_TRUE(take(line)) << "it has no feed";
    line.to[0] = 20.0;
    line.feed = {600.0, program::FeedUnit::mm_per_min};
    EXPECT_FALSE(take(line));
    // About X0 Y0 from X20; from X0 it would be no circle.
    program::Arc arc;
    arc.to[1] = 20.0;
    arc.sweep_deg = 90.0;
    arc.feed = line.feed;
    EXPECT_FALSE(take(arc));
    if (depth == Forecast::Depth::timed) {
      EXPECT_NEAR((10.0 + 31.416) / 10.0, forecast.motion_seconds(), 1e-3);
    }
  }
}

/// What a program of commands is refused for, each with its motion from 0, 0, 0; empty: it can be driven.
std::string refused(const Machine& m, const std::vector<decltype(program::Command::what)>& what) {
  Forecast forecast(Forecast::Depth::drivable, m.path, m.axes, {});
  for (const auto& each : what) {
    program::Command command;
    command.what = each;
    if (const auto finding = forecast.take(command)) return std::string(finding->entry->id);
  }
  return {};
}

program::Thread tap_to(double z) {
  program::Thread t;
  t.to[2] = z;
  t.lead = 1.25;
  t.tap = true;
  return t;
}

program::Spindle turning(program::SpindleMode mode) {
  program::Spindle s;
  s.mode = mode;
  s.speed = 500.0;
  return s;
}

TEST(Forecast, takes_taps_with_a_dwell_and_with_broken_chips_as_one_motion_each) {
  const Machine m = machine(1000.0, 10000.0);
  const program::Spindle in = turning(program::SpindleMode::cw), out = turning(program::SpindleMode::ccw);
  EXPECT_EQ(refused(m, {in, tap_to(-20), out, tap_to(0), in, program::End{}}), "");
  EXPECT_EQ(refused(m, {in, tap_to(-20), program::Dwell{0.5}, out, tap_to(0), in, program::End{}}), "");
  EXPECT_EQ(refused(m, {in, tap_to(-8), out, tap_to(-7), in, tap_to(-15), out, tap_to(0), program::End{}}),
            "");
  EXPECT_EQ(refused(m, {in, tap_to(-8), tap_to(-15), out, tap_to(0), program::End{}}), "")
      << "two ways in the same sense are one";
}

TEST(Forecast, refuses_a_tap_that_does_not_come_back_as_the_run_would) {
  const Machine m = machine(1000.0, 10000.0);
  const program::Spindle in = turning(program::SpindleMode::cw), out = turning(program::SpindleMode::ccw);
  EXPECT_EQ(refused(m, {in, tap_to(-20), program::End{}}), "channel.tap-open");
  EXPECT_EQ(refused(m, {in, tap_to(-20), out, program::End{}}), "channel.tap-open");
  EXPECT_EQ(refused(m, {in, tap_to(-20), out, tap_to(-5), program::End{}}), "channel.tap-open");
  EXPECT_EQ(refused(m, {in, tap_to(-20), out, tap_to(-25)}), "channel.tap-open") << "not back";
  EXPECT_EQ(refused(m, {in, tap_to(-20), turning(program::SpindleMode::stop)}), "channel.tap-open");
  EXPECT_EQ(refused(m, {in, tap_to(-20), program::Rapid{}}), "channel.tap-open");
}

TEST(Forecast, refuses_a_tap_whose_way_out_is_faster_than_its_axis) {
  Machine m = machine(1000.0, 10000.0);
  const program::Spindle in = turning(program::SpindleMode::cw);
  program::Spindle out = turning(program::SpindleMode::ccw);
  m.path.limits[2].velocity = 1.25 * out.speed / 60.0;
  EXPECT_EQ(refused(m, {in, tap_to(-20), out, tap_to(0)}), "");
  out.speed *= 1.01;
  EXPECT_EQ(refused(m, {in, tap_to(-20), out, tap_to(0)}), "channel.tap-too-fast");
}

TEST(Forecast, refuses_a_tap_without_room_beyond_its_depth_for_a_spindle_that_turns_round_late) {
  Machine m = machine(1000.0, 10000.0);
  m.path.threads.travel_min[2] = -22.0;
  m.path.threads.tap_overshoot = 3.0;
  const program::Spindle in = turning(program::SpindleMode::cw), out = turning(program::SpindleMode::ccw);
  EXPECT_EQ(refused(m, {in, tap_to(-18.9), out, tap_to(0)}), "");
  EXPECT_EQ(refused(m, {in, tap_to(-19.1), out, tap_to(0)}), "channel.tap-leaves-travel");
}

}  // namespace
}  // namespace servogate::channel::test
