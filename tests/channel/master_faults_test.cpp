// SPDX-License-Identifier: Apache-2.0
// Each fault of a master or a probe in each phase of the motion that goes by it: a controlled stop, and an
// alarm that names it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kernel/axis/alarms/axis_alarms.hpp"
#include "kernel/channel/alarms/master_alarms.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;

struct Fault {
  const char* name;
  void (*strike)(Rig&);
};
constexpr Fault kMasterFaults[] = {
    {"lost", [](Rig& r) { r.drives.spindle_silent = true; }},
    {"stuck", [](Rig& r) { r.drives.spindle_stuck = true; }},
    {"reversed", [](Rig& r) { r.drives.spindle_backwards = true; }},
    {"out of its window", [](Rig& r) { r.drives.turns += 0.3; }},
    {"not enabled", [](Rig& r) { r.logic.spindle_enable = false; }},
};

struct Phase {
  const char* name;
  bool (*there)(const Rig&);
  void (*enter)(Rig&) = nullptr;  ///< what is asked for when it is there, 20 ms before the fault
};

double speed(const Rig& r) { return r.image().axes[2].command_velocity; }
double rpm(const Rig& r) { return r.image().spindles[0].actual_rpm; }
void hold(Rig& r) { EXPECT_EQ(r.ask(RequestKind::hold), cycle::Refusal::none); }

constexpr image::AlarmNumber kMasterAlarms[] = {alarm::kThreadMasterLost, alarm::kThreadMasterTurned,
                                                alarm::kThreadWindow,     alarm::kThreadSpindleStands,
                                                alarm::kTapTooDeep,       alarm::kTapNoTurn};

int of_master(const Rig& rig) {
  int n = 0;
  for (const image::AlarmNumber number : kMasterAlarms) n += rig.alarms(number);
  return n;
}

bool over(const Rig& r) {
  return (r.state() == ProcessState::stopped_by_alarm || r.state() == ProcessState::ended) && !r.moving();
}

/// The fault in the phase; false: the program ended before the phase was there.
bool strike(Rig& rig, const Phase& phase, const Fault& fault) {
  rig.start();
  if (!rig.until([&] { return phase.there(rig) || over(rig); }) || over(rig)) return false;
  if (phase.enter != nullptr) {
    phase.enter(rig);
    rig.run(0.02);
  }
  fault.strike(rig);
  return true;
}

TEST(MasterFaults, of_a_thread_in_each_phase_leave_the_part_inside_the_limits_with_one_alarm) {
  constexpr Phase kPhases[] = {
      {"accelerating", [](const Rig& r) { return speed(r) < -2.0; }},
      {"cruise", [](const Rig& r) { return r.status().by_spindle && r.x(2) < -20.0; }},
      {"shortly before its end", [](const Rig& r) { return r.x(2) < -57.0; }},
      {"held until its end", [](const Rig& r) { return r.x(2) < -20.0; }, hold},
  };
  for (const Phase& phase : kPhases)
    for (const Fault& fault : kMasterFaults) {
      SCOPED_TRACE(std::string(fault.name) + ", " + phase.name);
      Rig rig("S600 M3\nG33 Z-60 K1.5\nG0 X4\nG0 Z0\nM30\n");
      ASSERT_TRUE(strike(rig, phase, fault)) << rig.alarm_list();
      const double there = rig.x(2);
      ASSERT_TRUE(rig.until([&] { return over(rig); }, 20.0)) << rig.alarm_list();
      EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
      EXPECT_EQ(of_master(rig), 1) << rig.alarm_list();
      EXPECT_NEAR(rig.x(0), 2.0, 1e-6) << "off the part as declared";
      EXPECT_GE(rig.x(2), -60.0 - 1e-6);
      EXPECT_LE(std::abs(rig.x(2) - there), 10.0) << "and soon";
      EXPECT_EQ(rig.violations(), "");
    }
}

TEST(MasterFaults, of_a_thread_that_is_being_left_change_nothing_of_the_way_off_the_part) {
  for (const Fault& fault : kMasterFaults) {
    SCOPED_TRACE(fault.name);
    Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n", "G27", 0.5, RigKind::retracting);
    const Phase retract{"retract", [](const Rig& r) { return r.x(2) < -20.0; }, hold};
    ASSERT_TRUE(strike(rig, retract, fault));
    ASSERT_TRUE(rig.until([&] { return over(rig); }, 20.0)) << rig.alarm_list();
    EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
    EXPECT_EQ(rig.alarms(alarm::kThreadHeld) + of_master(rig), 1) << rig.alarm_list();
    EXPECT_NEAR(rig.x(0), 2.0, 1e-6);
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(MasterFaults, of_a_tap_in_each_phase_stop_it_inside_the_limits_and_above_its_bound) {
  constexpr Phase kPhases[] = {
      {"accelerating", [](const Rig& r) { return r.x(2) < 2.0 && speed(r) < -2.0; }},
      {"cruise", [](const Rig& r) { return r.status().by_spindle && r.x(2) < -8.0; }},
      {"braking to its depth", [](const Rig& r) { return r.x(2) < -20.0 && rpm(r) < 400.0; }},
      {"out of the hole", [](const Rig& r) { return r.x(2) < -8.0 && rpm(r) < -450.0; }},
      {"held", [](const Rig& r) { return r.status().by_spindle && r.x(2) < -8.0; }, hold},
      {"stopped", [](const Rig& r) { return r.status().by_spindle && r.x(2) < -8.0; },
       [](Rig& r) { EXPECT_EQ(r.ask(RequestKind::stop), cycle::Refusal::none); }},
  };
  for (const Phase& phase : kPhases)
    for (const Fault& fault : kMasterFaults) {
      // A tap goes on behind its spindle as far as tap_overshoot lets it.
      if (std::string(fault.name) == "out of its window") continue;
      SCOPED_TRACE(std::string(fault.name) + ", " + phase.name);
      Rig rig("S500 M3\nG0 Z5\nG84 R2 Z-25 K1.5\nX10\nG80\nG0 X20\nM30\n");
      ASSERT_TRUE(strike(rig, phase, fault)) << rig.alarm_list();
      double deepest = 0.0;
      rig.each = [&] { deepest = std::min(deepest, rig.x(2)); };
      ASSERT_TRUE(rig.until([&] { return rig.state() != ProcessState::running && !rig.moving(); }, 30.0))
          << rig.alarm_list();
      if (std::string(phase.name) != "stopped") {
        EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
        EXPECT_GE(of_master(rig), 1) << rig.alarm_list();
      }
      EXPECT_GE(deepest, -25.0 - 3.0 - 1e-6) << "tap_overshoot";
      EXPECT_EQ(rig.violations(), "");
      rig.run(1.0);
      EXPECT_EQ(rig.image().spindles[0].command_rpm, 0.0) << "the spindle is told to stop";
    }
}

TEST(MasterFaults, of_a_tap_that_dwells_at_its_depth_stop_it_there) {
  for (const Fault& fault : kMasterFaults) {
    if (std::string(fault.name) == "out of its window" || std::string(fault.name) == "stuck") continue;
    SCOPED_TRACE(fault.name);
    Rig rig("S500 M3\nG95\nG0 Z5.\nG84 Z-15. R2. P400 F1.5\nG80\nM30\n", "G291", 0.5, RigKind::mill,
            "sinumerik-808d");
    const Phase dwell{"dwell", [](const Rig& r) { return r.x(2) < -13.0 && std::abs(rpm(r)) < 1.0; }};
    ASSERT_TRUE(strike(rig, dwell, fault)) << rig.alarm_list();
    double deepest = 0.0;
    rig.each = [&] { deepest = std::min(deepest, rig.x(2)); };
    ASSERT_TRUE(rig.until([&] { return over(rig); }, 30.0)) << rig.alarm_list();
    EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
    EXPECT_GE(of_master(rig), 1) << rig.alarm_list();
    EXPECT_GE(deepest, -15.0 - 3.0 - 1e-6);
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(MasterFaults, of_a_coupling_in_each_phase_stop_the_axes_and_bring_both_spindles_down) {
  constexpr Fault kFaults[] = {
      {"first lost", [](Rig& r) { r.drives.spindle_silent = true; }},
      {"first stuck", [](Rig& r) { r.drives.spindle_stuck = true; }},
      {"first reversed", [](Rig& r) { r.drives.spindle_backwards = true; }},
      {"first tripped", [](Rig& r) { r.drives.spindle_fault = true; }},
      {"second stuck", [](Rig& r) { r.drives.second_stuck = true; }},
  };
  constexpr Phase kPhases[] = {
      {"accelerating", [](const Rig& r) { return r.image().spindles[1].at_speed && rpm(r) > 610.0; }},
      {"cruise", [](const Rig& r) { return r.x(0) > 30.0; }},
      {"held", [](const Rig& r) { return r.x(0) > 30.0; }, hold},
  };
  for (const Phase& phase : kPhases)
    for (const Fault& fault : kFaults) {
      SCOPED_TRACE(std::string(fault.name) + ", " + phase.name);
      Rig rig("G98\nM03 S600\nG51.2 P1 Q2\nG01 X10. F600.\nS900\nG01 X200. F600.\nM30\n", "", 0.5,
              RigKind::polygon);
      ASSERT_TRUE(strike(rig, phase, fault)) << rig.alarm_list();
      ASSERT_TRUE(
          rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }, 30.0))
          << rig.alarm_list();
      EXPECT_LT(rig.x(0), 100.0);
      EXPECT_EQ(rig.violations(), "");
      EXPECT_TRUE(rig.until(
          [&] {
            return rig.image().spindles[0].command_rpm == 0.0 && rig.image().spindles[1].command_rpm == 0.0;
          },
          10.0))
          << rig.alarm_list();
    }
}

TEST(MasterFaults, of_a_probe_in_each_phase_of_a_measuring_motion_stop_it_with_the_alarm_of_the_fault) {
  struct Cell {
    const char* name;
    bool (*there)(const Rig&);
    void (*strike)(Rig&);
    image::AlarmNumber alarm;
  };
  constexpr auto touch = [](Rig& r) {
    r.drives.clearance = [](const std::array<double, kAxes>&) { return -1.0; };
  };
  constexpr auto nothing = [](Rig& r) { r.drives.surface_at(-500.0); };
  // (DPT,10,12,600): at rapid to Z-40, measured to Z-62 at 10 mm/s, and at rapid back.
  const Cell kCells[] = {
      {"deflected while the rapid accelerates", [](const Rig& r) { return r.x(2) < -0.5; }, touch,
       alarm::kProbeInRapid},
      {"deflected in the rapid", [](const Rig& r) { return r.x(2) < -15.0; }, touch, alarm::kProbeInRapid},
      {"deflected while the rapid brakes", [](const Rig& r) { return r.x(2) < -39.0 && speed(r) < -1.0; },
       touch, alarm::kProbeInRapid},
      {"nothing there, accelerating", [](const Rig& r) { return r.x(2) < -40.01; }, nothing,
       alarm::kProbeMissed},
      {"nothing there, measuring", [](const Rig& r) { return r.x(2) < -45.0; }, nothing, alarm::kProbeMissed},
      {"nothing there, held", [](const Rig& r) { return r.x(2) < -45.0; },
       [](Rig& r) {
         hold(r);
         EXPECT_TRUE(r.until([&] { return r.state() == ProcessState::held && !r.moving(); }));
         r.drives.surface_at(-500.0);
         EXPECT_EQ(r.ask(RequestKind::resume), cycle::Refusal::none);
       },
       alarm::kProbeMissed},
      {"stuck while it brakes behind the touch",
       [](const Rig& r) { return r.image().packets.bit(kProbePlace); }, touch, alarm::kProbeNotFree},
      {"stuck in the rapid back", [](const Rig& r) { return r.x(2) < -40.0 && speed(r) > 1.0; }, touch,
       alarm::kProbeNotFree},
  };
  for (const Cell& cell : kCells) {
    SCOPED_TRACE(cell.name);
    Rig rig("(DPT,10,12,600)\nG72 Z-50 E30\nG0 X7\nM30\n");
    rig.drives.surface_at(-50.0);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return cell.there(rig); })) << rig.alarm_list();
    cell.strike(rig);
    ASSERT_TRUE(rig.until([&] { return over(rig); }, 30.0)) << rig.alarm_list();
    EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
    EXPECT_EQ(rig.alarms(cell.alarm), 1) << rig.alarm_list();
    EXPECT_EQ(rig.x(0), 0.0) << "the program does not go on";
    EXPECT_EQ(rig.violations(), "");
  }
}

}  // namespace
}  // namespace servogate::channel::test
