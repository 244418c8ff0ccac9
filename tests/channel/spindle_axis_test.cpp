// SPDX-License-Identifier: Apache-2.0
// Programs whose spindle becomes a rotary axis, and a spindle again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "kernel/program/check/check.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::Mode;
using image::ProcessState;
using image::RequestKind;

struct Turning : Rig {
  explicit Turning(std::string_view program) : Rig(program, "G27", 0.5, RigKind::c_axis) {}
  bool is_spindle() const { return cycle->axes()[1].asleep(); }
  bool is_axis() const { return !is_spindle() && cycle->axes()[1].owner() == image::AxisOwner::process; }
  /// Degrees at which the spindle truly stands.
  double angle() const { return drives.turns * 360.0; }
  double rpm() const { return image().spindles[0].actual_rpm; }
  bool type(std::string_view block) {
    process->set_manual_block(std::string(block));
    if (ask(RequestKind::mode, static_cast<double>(Mode::mdi)) != cycle::Refusal::none) return false;
    return finish();
  }
  void automatic() {
    ASSERT_EQ(ask(RequestKind::mode, static_cast<double>(Mode::automatic)), cycle::Refusal::none);
  }
};

double off(double a, double b) { return std::abs(a - b - 360.0 * std::round((a - b) / 360.0)); }

TEST(SpindleAxisProgram, makes_the_spindle_an_axis_that_interpolates_with_the_others_and_a_spindle_again) {
  Turning rig("S600 M3\nG1 X1 F600\nM70\nG1 C90 F3600\nG1 X10 C450 F600\nM71\nS900 M3\nX20 F600\nM5\nM30\n");
  bool before = false, together = false, apart = false, after = false;
  rig.each = [&] {
    before = before || (rig.rpm() > 590.0 && !rig.is_axis());
    if (rig.is_axis() && rig.x() > 2.0 && rig.x() < 9.0) {
      together = true;
      // From 90 degrees at X1 to 450 at X10: 40 degrees a millimetre.
      apart = apart || std::abs(rig.x(1) - 90.0 - (rig.x() - 1.0) * 40.0) > 0.01;
    }
    after = after || rig.rpm() > 890.0;
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_TRUE(before);
  EXPECT_TRUE(together);
  EXPECT_FALSE(apart) << "on one line";
  EXPECT_TRUE(after);
  EXPECT_NEAR(rig.x(), 20.0, 1e-6);
  EXPECT_NEAR(rig.x(1), 450.0, 1e-6) << "where the axis goes on";
  EXPECT_EQ(rig.alarm_list(), "");
}

TEST(SpindleAxisProgram, stands_truly_at_the_angle_of_its_axis_each_time) {
  Turning rig("M70\nG0 C30\nM0\nM71\nS700 M3\nTMR=2\nG4\nM70\nM0\nG0 C-75.5\nM0\nM30\n");
  rig.start();
  for (const double wanted : {30.0, 30.0, -75.5}) {
    ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == image::WaitReason::program_stop; }))
        << rig.alarm_list();
    EXPECT_LE(off(rig.angle(), wanted), 0.2);
    EXPECT_NEAR(rig.x(1), wanted, 1e-6);
    ASSERT_EQ(rig.ask(RequestKind::resume), cycle::Refusal::none);
    rig.run(0.01);
  }
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
}

TEST(SpindleAxisProgram, waits_for_the_standstill_and_says_what_it_waits_for) {
  Turning rig("S2000 M3\nG1 X1 F600\nM70\nG1 X2 F600\nM30\n");
  int waits = 0;
  double fastest = 0.0;
  rig.each = [&] {
    if (rig.status().wait.reason == image::WaitReason::signal) ++waits;
    if (rig.moving() && rig.x() > 1.0) fastest = std::max(fastest, std::abs(rig.rpm()));
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(waits, 100);
  EXPECT_LE(fastest, 1.0);
}

TEST(SpindleAxisProgram, is_a_spindle_at_rest_behind_its_end_a_stop_a_reset_and_an_alarm) {
  const std::string along = "M70\nG1 C720 F3600\nM30\n";
  for (const int how : {0, 1, 2, 3}) {
    Turning rig(along);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x(1) > 100.0; })) << rig.alarm_list();
    double steepest = 0.0, last = 0.0;
    rig.each = [&] {
      const double v = rig.image().axes[1].command_velocity;
      steepest = std::max(steepest, std::abs(v - last));
      last = v;
    };
    rig.run(0.01);
    steepest = 0.0;
    if (how == 3) rig.logic.external_alarm = 7;
    if (how == 1 || how == 2) {
      ASSERT_EQ(rig.ask(how == 1 ? RequestKind::stop : RequestKind::reset), cycle::Refusal::none);
    }
    ASSERT_TRUE(rig.until([&] { return rig.is_spindle(); }, 60.0)) << how;
    EXPECT_LE(steepest, kLimits.acceleration * 0.001 * 1.01) << how << ": it comes to rest within its limits";
    const double stood = rig.drives.turns;
    rig.run(2.0);
    EXPECT_EQ(rig.drives.turns, stood) << how;
    EXPECT_FALSE(rig.image().spindles[0].running);
    EXPECT_FALSE(rig.image().spindles[0].drive_command.power);
  }
}

TEST(SpindleAxisProgram, that_is_stopped_or_reset_in_any_phase_of_the_change_is_a_spindle_at_rest) {
  for (const RequestKind kind : {RequestKind::stop, RequestKind::reset})
    for (double after = 0.02; after < 2.5; after += 0.173) {
      Turning rig("S600 M3\nG1 X1 F600\nM70\nG1 C720 F3600\nM30\n");
      rig.start();
      ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::running && rig.x() >= 1.0; }));
      rig.run(after);
      ASSERT_EQ(rig.ask(kind), cycle::Refusal::none) << after;
      ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::idle && rig.is_spindle(); })) << after;
      EXPECT_EQ(rig.alarm_list(), "") << after;
      // What turned before the change turns on behind a stop, as behind any other.
      if (rig.image().spindles[0].running && kind == RequestKind::stop) continue;
      ASSERT_TRUE(rig.until([&] { return std::abs(rig.rpm()) < 1.0; })) << after;
      const double stood = rig.drives.turns;
      rig.run(0.3);
      EXPECT_NEAR(rig.drives.turns, stood, 0.01) << after;
    }
}

/// Its drive trips while X moves, and the program is stopped.
bool trips_on_its_way(Turning& rig) {
  rig.start();
  if (!rig.until([&] { return rig.x() > 5.0; })) return false;
  rig.drives.spindle_fault = true;
  return rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; });
}

TEST(SpindleAxisProgram, whose_drive_trips_as_an_axis_stops_all_and_turns_nothing_when_it_is_acknowledged) {
  Turning rig("M70\nG1 X100 C720 F600\nM30\n");
  ASSERT_TRUE(trips_on_its_way(rig)) << rig.alarm_list();
  EXPECT_EQ(rig.alarms(axis::alarm::kDriveFault), 1);
  EXPECT_EQ(rig.alarms(axis::alarm::kSpindleDriveFault), 0);
  ASSERT_TRUE(rig.until([&] { return rig.is_spindle() && !rig.moving(); }));
  rig.drives.spindle_fault = false;
  ASSERT_EQ(rig.ask(RequestKind::reset), cycle::Refusal::none);
  const double stood = rig.drives.turns;
  rig.run(2.0);
  EXPECT_EQ(rig.drives.turns, stood);
}

TEST(SpindleAxisProgram, whose_drive_trips_as_a_spindle_stops_the_axes) {
  Turning rig("S600 M3\nG1 X100 F600\nM70\nM30\n");
  ASSERT_TRUE(trips_on_its_way(rig)) << rig.alarm_list();
  EXPECT_EQ(rig.alarms(axis::alarm::kSpindleDriveFault), 1);
  EXPECT_EQ(rig.alarms(axis::alarm::kDriveFault), 0);
}

TEST(SpindleAxisProgram, leaves_a_typed_axis_to_the_next_typed_block_and_not_to_a_program) {
  Turning rig("S600 M3\nTMR=1\nG4\nM5\nM30\n");
  ASSERT_TRUE(rig.type("M70")) << rig.alarm_list();
  ASSERT_TRUE(rig.type("G0 C45")) << rig.alarm_list();
  EXPECT_LE(off(rig.angle(), 45.0), 0.2);
  EXPECT_EQ(rig.ask(RequestKind::reset), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.is_spindle(); }));
  rig.process->set_manual_block("G0 C90");
  rig.start();
  EXPECT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_NEAR(rig.x(1), 45.0, 1e-6) << "a spindle has no place to go to";
  ASSERT_EQ(rig.ask(RequestKind::reset), cycle::Refusal::none);
  ASSERT_TRUE(rig.type("M70"));
  rig.automatic();
  double fastest = 0.0;
  rig.each = [&] { fastest = std::max(fastest, rig.rpm()); };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(fastest, 590.0) << "the program begins with a spindle";
}

TEST(SpindleAxisProgram, has_no_axis_for_the_hand_while_it_is_a_spindle) {
  Turning rig("M30\n");
  ASSERT_EQ(rig.ask(RequestKind::mode, static_cast<double>(Mode::manual)), cycle::Refusal::none);
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 10.0, 1), cycle::Refusal::axis_is_spindle);
  EXPECT_EQ(rig.ask(RequestKind::jog_continuous, 1.0, 1), cycle::Refusal::axis_is_spindle);
  EXPECT_EQ(rig.ask(RequestKind::jog_increment, 10.0, 0), cycle::Refusal::none) << "others move";
}

}  // namespace
}  // namespace servogate::channel::test
