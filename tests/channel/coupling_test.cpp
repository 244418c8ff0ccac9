// SPDX-License-Identifier: Apache-2.0
// Programs whose second spindle follows the first one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/channel/motion/forecast.hpp"
#include "kernel/program/check/check.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;

struct Coupled : Rig {
  explicit Coupled(std::string_view program) : Rig(program, "", 0.5, RigKind::polygon) {}
  double rpm(std::size_t spindle) const { return image().spindles[spindle].actual_rpm; }
  /// At rest, and with no order to turn or to follow.
  bool both_stand() const { return !image().spindles[0].running && !image().spindles[1].running; }
  bool in_step() const { return image().spindles[1].at_speed; }
  /// A typed block, to its end.
  bool type(std::string_view block) {
    process->set_manual_block(std::string(block));
    if (ask(RequestKind::mode, static_cast<double>(image::Mode::mdi)) != cycle::Refusal::none) return false;
    return finish();
  }
  void automatic() {
    ASSERT_EQ(ask(RequestKind::mode, static_cast<double>(image::Mode::automatic)), cycle::Refusal::none);
  }
};

TEST(CoupledProgram, does_not_move_out_of_step_where_the_first_spindle_turns_behind_the_coupling) {
  Coupled rig("G98\nG51.2 P1 Q2\nM03 S600\nG01 X20. F600.\nG50.2\nM30\n");
  int moves = 0, out_of_step = 0, waits = 0;
  rig.each = [&] {
    if (rig.status().wait.reason == image::WaitReason::signal) ++waits;
    if (!rig.moving()) return;
    ++moves;
    if (!rig.in_step()) ++out_of_step;
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(moves, 1000);
  EXPECT_EQ(out_of_step, 0);
  EXPECT_GT(waits, 0) << "it says what it waits for";
  EXPECT_NEAR(rig.x(), 20.0, 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

TEST(CoupledProgram, moves_as_ever_while_the_first_spindle_is_not_to_turn) {
  Coupled rig("G98\nG51.2 P1 Q2\nG01 X20. F600.\nG50.2\nM30\n");
  ASSERT_TRUE(rig.finish(10.0)) << rig.alarm_list();
  EXPECT_NEAR(rig.x(), 20.0, 1e-6);
}

constexpr const char* kLong = "G98\nM03 S600\nG51.2 P1 Q2\nG01 X200. F600.\nM30\n";

TEST(CoupledProgram, that_is_stopped_brings_both_spindles_down_and_leaves_no_coupling_to_the_next_one) {
  for (const RequestKind ends : {RequestKind::stop, RequestKind::reset}) {
    Coupled rig(kLong);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x() > 5.0; })) << rig.alarm_list();
    ASSERT_TRUE(rig.in_step());
    ASSERT_EQ(rig.ask(ends), cycle::Refusal::none);
    ASSERT_TRUE(rig.until([&] { return !rig.moving() && rig.both_stand(); }, 10.0));
    rig.load("M03 S600\nG04 X2.\nM05\nM30\n");
    double most = 0.0;
    rig.each = [&] { most = std::max(most, std::abs(rig.image().spindles[1].command_rpm)); };
    ASSERT_TRUE(rig.finish()) << rig.alarm_list();
    EXPECT_EQ(most, 0.0) << "the cutter does not start unasked";
  }
}

TEST(CoupledProgram, goes_back_along_its_path_in_step_only) {
  Coupled rig(kLong);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 30.0; })) << rig.alarm_list();
  ASSERT_EQ(rig.ask(RequestKind::hold), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held && !rig.moving(); }));
  const auto function = [&](image::Function what, double value) {
    image::Request r;
    r.kind = RequestKind::function;
    r.index = static_cast<std::uint32_t>(what);
    r.value = value;
    return rig.ask(r);
  };
  ASSERT_EQ(function(image::Function::spindle_stop, 0.0), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return std::abs(rig.rpm(0)) < 1.0 && std::abs(rig.rpm(1)) < 1.0; }, 10.0));
  rig.run(1.0);
  ASSERT_EQ(function(image::Function::spindle_clockwise, 600.0), cycle::Refusal::none);
  rig.run(0.05);
  ASSERT_FALSE(rig.in_step());
  int moves = 0, out_of_step = 0;
  rig.each = [&] {
    if (!rig.moving()) return;
    ++moves;
    if (!rig.in_step()) ++out_of_step;
  };
  image::Request back;
  back.kind = RequestKind::retrace;
  back.value = 10.0;
  ASSERT_EQ(rig.ask(back), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return !rig.status().retracing && !rig.moving(); }, 60.0));
  EXPECT_GT(moves, 100);
  EXPECT_LE(out_of_step, 1) << "it comes into step in the cycle";
  EXPECT_TRUE(rig.status().retraced);
}

TEST(CoupledProgram, that_an_alarm_stops_brings_both_spindles_down) {
  Coupled rig(kLong);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x() > 5.0; })) << rig.alarm_list();
  rig.drives.fault[1] = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_TRUE(rig.until([&] { return rig.both_stand(); }, 10.0));
}

TEST(CoupledProgram, does_not_take_over_a_coupling_that_was_typed) {
  Coupled rig("G04 X2.\nM00\nM30\n");
  ASSERT_TRUE(rig.type("M03 S600")) << rig.alarm_list();
  ASSERT_TRUE(rig.type("G51.2 P1 Q2")) << rig.alarm_list();
  ASSERT_TRUE(rig.in_step());
  rig.run(1.0);
  ASSERT_TRUE(rig.in_step()) << "a typed block leaves it as it set it";
  rig.automatic();
  rig.start();
  EXPECT_TRUE(rig.until([&] { return !rig.image().spindles[1].running; }, 5.0));
  EXPECT_NEAR(rig.rpm(0), 600.0, 5.0);
}

TEST(CoupledProgram, that_is_not_running_ends_a_typed_coupling_by_a_stop) {
  Coupled rig("M30\n");
  ASSERT_TRUE(rig.type("M03 S600")) << rig.alarm_list();
  ASSERT_TRUE(rig.type("G51.2 P1 Q2")) << rig.alarm_list();
  ASSERT_EQ(rig.ask(RequestKind::stop), cycle::Refusal::none);
  EXPECT_TRUE(rig.until([&] { return rig.both_stand(); }, 10.0));
}

TEST(CoupledProgram, with_a_tap_under_the_coupling_is_an_error_before_it_turns_back) {
  Coupled rig("G99\nM03 S500\nG51.2 P1 Q2\nG00 Z5.\nG84 Z-20. R-3. F1.5\nG80\nM30\n");
  double lowest = 0.0;
  rig.each = [&] { lowest = std::min(lowest, rig.x(2)); };
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(cycle::alarm::kProgramError), 1) << rig.alarm_list();
  EXPECT_EQ(lowest, 0.0);
  EXPECT_TRUE(rig.until([&] { return rig.both_stand(); }, 10.0));
}

TEST(CoupledProgram, with_a_tap_under_the_coupling_is_refused_by_the_check_with_its_place) {
  program::MachineModel model;
  path::Config path;
  AxisMap axes;
  for (const char* letter : {"X", "Z"}) {
    axes.machine.push_back(static_cast<int>(model.axes.size()));
    path.limits[model.axes.size()] = {500.0, 1000.0, 10000.0};
    path.threads.travel_min[model.axes.size()] = -1e6;
    path.threads.travel_max[model.axes.size()] = 1e6;
    model.axes.push_back({letter, true, false, false, -1e6, 1e6, 500.0});
  }
  path.axis_count = 2;
  path.period_s = 1e-3;
  model.kind = program::MachineModel::Kind::turning;
  model.power_on = {"G291"};
  model.coupled_max_rpm = kSpindleMax;
  const auto errors = [&](const char* text) {
    Forecast forecast(Forecast::Depth::timed, path, axes, {});
    std::string found;
    const program::CheckReport report =
        program::check_program("sinumerik-808d", model, {}, "p.nc", text, {}, {},
                               [&](const program::Command& c) { return forecast.take(c); });
    for (const text::Finding& f : report.findings)
      if (f.severity == text::Severity::error) found += f.str(text::Language::english) + "\n";
    return found;
  };
  const std::string coupled = errors("G99\nM03 S500\nG51.2 P1 Q2\nG00 Z5.\nG84 Z-20. R-3. F1.5\nG80\nM30\n");
  EXPECT_EQ(coupled.find("p.nc:5:"), 0u) << coupled;
  EXPECT_NE(coupled.find("channel.tap-coupled"), std::string::npos) << coupled;
  EXPECT_EQ(errors("G99\nM03 S500\nG51.2 P1 Q2\nG00 Z5.\nG50.2\nG84 Z-20. R-3. F1.5\nG80\nM30\n"), "");
}

TEST(CoupledProgram, taps_behind_the_end_of_the_coupling) {
  Coupled rig("G99\nM03 S500\nG51.2 P1 Q2\nG00 Z5.\nG50.2\nG84 Z-20. R-3. F1.5\nG80\nM30\n");
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_EQ(rig.violations(), "");
}

}  // namespace
}  // namespace servogate::channel::test
