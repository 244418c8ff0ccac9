// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/control/power_sequence.hpp"

#include <gtest/gtest.h>

#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

using image::Reaction;
using test::Rig;
using State = PowerSequence::State;

AxisConfig vertical() {
  AxisConfig c = test::mill_axis();
  c.brake.output = BrakeOutput::place;
  c.brake.place = test::kBrakePlace;
  c.brake.torque_delay = 0.050;
  c.brake.release_delay = 0.100;
  c.brake.engage_delay = 0.080;
  return c;
}

bool brake_open(const Rig& rig) { return rig.image.packets.bit(test::kBrakePlace.place); }

TEST(Brake, opens_after_torque_is_there_and_permits_motion_after_its_delay) {
  Rig rig(vertical());
  rig.axis.request_power(true);
  int on = -1, open = -1, ready = -1;
  for (int i = 0; i < 400; ++i) {
    rig.cycle();
    if (on < 0 && rig.shared().drive.state == image::DriveState::operation_enabled) on = i;
    if (open < 0 && brake_open(rig)) open = i;
    if (ready < 0 && rig.axis.motion_permitted()) ready = i;
    if (ready < 0) {
      ASSERT_FALSE(rig.axis.jog_increment(1.0)) << "before the brake is open";
    }
  }
  EXPECT_NEAR(open - on, 50, 2);
  EXPECT_NEAR(ready - open, 100, 12);
  EXPECT_TRUE(rig.shared().brake_released);
  EXPECT_EQ(rig.plc("brake_release"), 1.0);
}

TEST(Brake, delays_begin_when_its_output_has_the_command) {
  AxisConfig slow = vertical();
  slow.brake.command_time = 0.150;
  Rig rig(slow);
  rig.axis.request_power(true);
  int open = -1, ready = -1;
  for (int i = 0; i < 500 && ready < 0; ++i) {
    rig.cycle();
    if (open < 0 && brake_open(rig)) open = i;
    if (rig.axis.motion_permitted()) ready = i;
  }
  EXPECT_NEAR(ready - open, 262, 2) << "no motion against a brake that is only being opened";
  rig.axis.request_power(false);
  int closed = -1, off = -1;
  for (int i = 0; i < 500 && off < 0; ++i) {
    rig.cycle();
    if (closed < 0 && !brake_open(rig)) closed = i;
    if (!rig.shared().drive_command.power) off = i;
  }
  EXPECT_NEAR(off - closed, 230, 2) << "no loss of torque before the brake has closed";
}

TEST(Brake, on_a_stop_the_axis_ramps_down_then_the_brake_closes_then_power_goes) {
  Rig rig(vertical());
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(-50.0));
  rig.run(500);
  rig.axis.request_power(false);
  int rest = -1, closed = -1, off = -1;
  for (int i = 0; i < 600; ++i) {
    rig.cycle();
    if (rest < 0 && rig.shared().command_velocity == 0.0) rest = i;
    if (closed < 0 && !brake_open(rig)) closed = i;
    if (off < 0 && !rig.shared().drive_command.power) off = i;
  }
  EXPECT_GT(rest, 20);
  EXPECT_GE(closed, rest);
  EXPECT_LE(closed, rest + 2);
  EXPECT_NEAR(off - closed, 80, 2);
  EXPECT_TRUE(rig.events.empty());
}

/// Switched off at the end of its path the axis drops by so much until its brake holds it: whether it is said
/// to stand off the path. `path_mm`: so far the path goes on meanwhile.
bool off_path_after_a_drop_of(std::int64_t counts, double path_mm = 0.0) {
  Rig rig(vertical());
  rig.reference_here();
  EXPECT_TRUE(rig.enable());
  EXPECT_TRUE(rig.axis.acquire(image::AxisOwner::process));
  rig.setpoint = Setpoint{0.0, 0.0, 0.0, 0.0};
  rig.run(20);
  rig.axis.request_power(false);
  EXPECT_TRUE(rig.run_until([&] { return !rig.shared().drive_command.power; }, 1000));
  rig.run(2);
  rig.drive.coast_counts = counts / 4;
  for (int n = 0; n < 4; ++n) {
    rig.setpoint = Setpoint{path_mm * (n + 1) / 4.0, path_mm / 0.004, 0.0, 0.0};
    rig.cycle();
  }
  rig.drive.coast_counts = 0;
  rig.setpoint = Setpoint{path_mm, 0.0, 0.0, 0.0};
  rig.run(2);
  rig.setpoint.reset();
  rig.run(500);
  return rig.raised(alarm::kOffPath);
}

TEST(Brake, that_lets_an_axis_settle_after_its_path_is_no_warning_within_what_it_may_slip) {
  EXPECT_FALSE(off_path_after_a_drop_of(-40));
  EXPECT_TRUE(off_path_after_a_drop_of(-2000)) << "slipped further than it may";
  EXPECT_TRUE(off_path_after_a_drop_of(-40, 0.2)) << "the path went on without it";
}

TEST(Brake, closes_in_the_same_cycle_when_the_power_has_to_go_and_the_torque_stays_until_it_holds) {
  Rig rig(vertical());
  ASSERT_TRUE(rig.enable());
  rig.reaction = Reaction::power_off;
  rig.cycle();
  EXPECT_FALSE(brake_open(rig));
  EXPECT_TRUE(rig.shared().drive_command.power);
  EXPECT_TRUE(rig.shared().drive_command.quick_stop);
  int cycles = 1;
  while (rig.shared().drive_command.power && cycles < 500) rig.cycle(), ++cycles;
  EXPECT_NEAR(cycles, 80, 2);
  rig.reaction = Reaction::none;
  rig.run(200);
  EXPECT_FALSE(rig.shared().drive_command.power) << "nothing comes on again unasked";
}

TEST(Brake, closes_after_the_ramp_with_the_reaction_stop_and_power_off) {
  Rig rig(vertical());
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_continuous(1, rig.image.now.t_ns));
  rig.run(60);
  ASSERT_GT(rig.shared().command_velocity, 0.0);
  rig.reaction = Reaction::stop_and_power_off;
  int moving = 0;
  while (rig.shared().moving && moving < 2000) {
    rig.cycle();
    ++moving;
    if (rig.shared().moving) {
      ASSERT_TRUE(brake_open(rig)) << moving;
      ASSERT_FALSE(rig.shared().drive_command.quick_stop) << "the control leads the ramp";
    }
  }
  ASSERT_LT(moving, 2000);
  ASSERT_GT(moving, 5);
  int held = 0;
  while (rig.shared().drive_command.power && held < 500) rig.cycle(), ++held;
  EXPECT_NEAR(held, 80, 3);
  EXPECT_FALSE(brake_open(rig));
  rig.reaction = Reaction::none;
  rig.run(200);
  EXPECT_FALSE(rig.shared().drive_command.power) << "nothing comes on again unasked";
}

TEST(Brake, closes_at_once_when_the_drive_loses_its_torque_in_its_quick_stop) {
  Rig rig(vertical());
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_continuous(1, rig.image.now.t_ns));
  rig.run(60);
  rig.reaction = Reaction::quick_stop;
  rig.drive.coast_counts = 400;  // per cycle
  rig.run(5);
  ASSERT_TRUE(rig.shared().drive_command.quick_stop);
  ASSERT_TRUE(brake_open(rig)) << "while the drive brakes";
  rig.drive.torque_off = true;
  rig.run(2);
  EXPECT_FALSE(brake_open(rig)) << "a falling axis never comes to the rest that would close it";
}

TEST(Brake, closes_at_once_when_the_drive_lets_go) {
  Rig rig(vertical());
  ASSERT_TRUE(rig.enable());
  rig.drive.fault = true;
  rig.run(1);
  EXPECT_FALSE(brake_open(rig));
}

TEST(Brake, that_loses_the_drive_before_it_was_open_says_so) {
  Rig rig(vertical());
  rig.axis.request_power(true);
  ASSERT_TRUE(rig.run_until([&] { return rig.axis.power_state() == State::torque; }, 100));
  rig.drive.enable_cycles = 1'000'000;
  rig.run(3);
  EXPECT_TRUE(rig.raised(alarm::kBrakeNoTorque));
  EXPECT_FALSE(brake_open(rig));
}

TEST(Brake, that_slips_is_an_alarm) {
  Rig rig(vertical());
  rig.run(100);
  for (int i = 0; i < 400; ++i) {
    rig.drive.counts -= 1;
    rig.cycle();
  }
  EXPECT_TRUE(rig.events.empty());
  for (int i = 0; i < 200; ++i) {
    rig.drive.counts -= 1;
    rig.cycle();
  }
  EXPECT_TRUE(rig.raised(alarm::kBrakeSlips));
}

TEST(Brake, can_be_the_output_of_the_drive) {
  AxisConfig c = vertical();
  c.brake.output = BrakeOutput::drive;
  Rig rig(c);
  ASSERT_TRUE(rig.enable());
  EXPECT_TRUE(rig.shared().drive_command.brake_release);
  EXPECT_FALSE(brake_open(rig));
}

TEST(Power, without_a_brake_goes_in_the_same_cycle_with_the_reaction_power_off) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  rig.reaction = Reaction::power_off;
  rig.cycle();
  EXPECT_FALSE(rig.shared().drive_command.power);
}

TEST(Power, of_an_axis_without_a_brake_goes_off_as_told_without_an_alarm) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(20.0));
  rig.run(100);
  rig.axis.request_power(false);
  rig.run(1500);
  EXPECT_FALSE(rig.shared().drive_command.power);
  EXPECT_TRUE(rig.events.empty());
}

/// The enable goes in the cycle `gone` of a power on with a jog, and comes again `for_cycles` later.
std::vector<Event> enable_gone(const AxisConfig& config, int gone, int for_cycles) {
  Rig rig(config);
  rig.axis.request_power(true);
  bool jogged = false, met = false;
  for (int i = 0; i < 1200; ++i) {
    if (i == gone) rig.plc("enable", false);
    if (i == gone + for_cycles) rig.plc("enable", true);
    const bool begins = !jogged && rig.axis.jog_increment(3.0);
    jogged = jogged || begins;
    met = met || (i == gone && (begins || rig.axis.moving()));
    rig.cycle();
    // What the cycle does with an alarm of this kind: the axes stop.
    if (rig.raised(alarm::kEnableWithdrawn)) rig.reaction = Reaction::stop_axes;
  }
  EXPECT_EQ(rig.raised(alarm::kEnableWithdrawn), met) << "gone in cycle " << gone;
  return rig.events;
}

TEST(Power, whose_enable_goes_in_whatever_cycle_is_withdrawn_in_motion_and_never_lost) {
  for (const AxisConfig& config : {test::mill_axis(), vertical()})
    for (int gone = 0; gone < 900; ++gone)
      for (int for_cycles : {1, 2, 7, 2000})
        for (const Event& e : enable_gone(config, gone, for_cycles))
          ASSERT_EQ(e.number, alarm::kEnableWithdrawn)
              << "gone in cycle " << gone << " for " << for_cycles << " cycles";
}

TEST(Power, in_a_quick_stop_the_drive_brakes_by_itself_and_the_command_follows_it) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(50.0));
  rig.run(200);
  rig.reaction = Reaction::quick_stop;
  rig.cycle();
  EXPECT_TRUE(rig.shared().drive_command.quick_stop);
  for (int i = 0; i < 20; ++i) {
    rig.cycle();
    ASSERT_EQ(rig.shared().drive_command.position_counts, rig.drive.counts);
  }
  rig.run(100);
  EXPECT_FALSE(rig.shared().drive_command.power);
  rig.reaction = Reaction::none;
  EXPECT_TRUE(rig.enable());
  EXPECT_LE(std::abs(rig.shared().following_error), 0.001);
}

}  // namespace
}  // namespace servogate::axis
