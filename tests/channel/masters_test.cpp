// SPDX-License-Identifier: Apache-2.0
// Programs whose path goes with the spindle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "kernel/channel/alarms/master_alarms.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;

/// Watches Z against the true revolutions of the spindle: a set-point acts two cycles before the encoder's
/// reading of the same time is there.
struct Watched : Rig {
  Watched(std::string_view program, double lead_mm, double begins_at = 0.0, RigKind kind = RigKind::mill)
      : Rig(program, "G27", 0.5, kind), lead(lead_mm), begins(begins_at) {
    each = [this] {
      z_ = {x(2), z_[0], z_[1]};
      const double speed = (z_[1] - z_[2]) * 1000.0, wanted = -lead * image().spindles[0].actual_rpm / 60.0;
      if (!(std::abs(speed - wanted) < 0.01 * std::abs(wanted)) || wanted == 0.0) {
        steady_ = 0;
        return;
      }
      if (++steady_ < 300) return;
      const double off = -z_[2] / lead - drives.turns + begins;
      worst = std::max(worst, std::abs(off - std::round(off)) * lead);
      ++seen;
    };
  }
  double lead, begins, worst = 0.0;
  int seen = 0;

 private:
  std::array<double, 3> z_{};
  int steady_ = 0;
};

TEST(ThreadProgram, is_cut_at_the_measured_angle_and_ends_where_it_is_programmed) {
  Watched rig("S600 M3\nG33 Z-60 K1.5\nG0 X4\nG0 Z0\nM30\n", 1.5);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  std::printf("thread of a program: %.3f um off the true angle, %d cycles\n", rig.worst * 1e3, rig.seen);
  EXPECT_GT(rig.seen, 1000);
  EXPECT_LE(rig.worst, 0.010);
  double deepest = 0.0;
  for (const std::array<double, kAxes>& at : rig.path) deepest = std::min(deepest, at[2]);
  EXPECT_NEAR(deepest, -60.0, 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, has_its_second_start_half_a_revolution_behind_the_first) {
  Watched rig("S600 M3\nG33 Z-40 K2 R180\nM30\n", 2.0, 0.5);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GT(rig.seen, 300);
  EXPECT_LE(rig.worst, 0.010);
}

TEST(ThreadProgram, takes_no_notice_of_the_feed_override_and_of_a_spindle_under_load) {
  Watched rig("S600 M3\nG33 Z-60 K1.5\nM30\n", 1.5);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
  rig.ask(RequestKind::override_feed, 0.2);
  rig.drives.slip = 0.1;
  rig.run(0.8);
  const double while_slowing = std::exchange(rig.worst, 0.0);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  const double bound = path::phase_bound({0.001, 0.002, 4096.0, 1.0, 20.0}, 1.5);
  std::printf("under load: %.2f um off while the spindle slows down, bound %.2f um\n", while_slowing * 1e3,
              bound * 1e3);
  EXPECT_LE(while_slowing, bound);
  EXPECT_LE(rig.worst, 0.010) << "at a tenth less, the lead is the same";
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, by_the_set_point_is_cut_as_the_spindle_is_held_to_it_and_its_passes_lie_in_one_groove) {
  Watched rig("S600 M3\nG33 Z-40 K1.5\nG0 X4\nG0 Z0\nG0 X0\nS750 M3\nG33 Z-40 K1.5\nM5\nM30\n", 1.5, 0.0,
              RigKind::setpoint);
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  std::printf("thread by the set-point: %.3f um off the true angle, %d cycles\n", rig.worst * 1e3, rig.seen);
  EXPECT_GT(rig.seen, 1000);
  EXPECT_LE(rig.worst, 0.010);
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, by_the_set_point_holds_the_spindle_against_a_load_where_the_measured_one_goes_slower) {
  for (const RigKind kind : {RigKind::setpoint, RigKind::mill}) {
    Watched rig("S600 M3\nG33 Z-90 K1.5\nM30\n", 1.5, 0.0, kind);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
    rig.drives.slip = 0.01;
    rig.run(1.5);
    rig.worst = 0.0;
    const double from = rig.drives.turns;
    rig.run(2.0);
    // 2 s at 600 rpm, of which the load takes 1 %.
    EXPECT_NEAR(rig.drives.turns - from, kind == RigKind::setpoint ? 20.0 : 19.8, 0.01);
    EXPECT_LE(rig.worst, 0.010);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(ThreadProgram, by_the_set_point_leaves_the_part_where_the_spindle_does_not_bear_its_load) {
  Rig rig("S600 M3\nG33 Z-90 K1.5\nM30\n", "G27", 0.5, RigKind::setpoint);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
  rig.drives.slip = 0.3;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kThreadWindow), 1) << rig.alarm_list();
  EXPECT_NEAR(rig.x(0), 2.0, 1e-6) << "off the part as declared";
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, by_the_set_point_leaves_the_part_where_the_spindle_is_not_read_or_stands) {
  for (const bool silent : {true, false}) {
    Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n", "G27", 0.5, RigKind::setpoint);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
    (silent ? rig.drives.spindle_silent : rig.drives.spindle_stuck) = true;
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
    EXPECT_EQ(rig.alarms(silent ? alarm::kThreadMasterLost : alarm::kThreadWindow), 1) << rig.alarm_list();
    EXPECT_NEAR(rig.x(0), 2.0, 1e-6);
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(ThreadProgram, that_is_held_ends_its_pass_and_goes_on_behind_it) {
  Rig rig("S600 M3\nG33 Z-40 K1.5\nG0 X4\nM30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
  EXPECT_EQ(rig.ask(RequestKind::hold), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held && !rig.moving(); }));
  EXPECT_NEAR(rig.x(2), -40.0, 1e-6);
  EXPECT_EQ(rig.x(0), 0.0);
  EXPECT_EQ(rig.ask(RequestKind::resume), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  EXPECT_NEAR(rig.x(0), 4.0, 1e-6);
}

TEST(ThreadProgram, that_is_held_leaves_the_part_with_an_alarm_where_that_is_declared) {
  Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n", "G27", 0.5, RigKind::retracting);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
  EXPECT_EQ(rig.ask(RequestKind::hold), cycle::Refusal::none);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kThreadHeld), 1) << rig.alarm_list();
  EXPECT_NEAR(rig.x(0), 2.0, 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, on_a_spindle_without_an_encoder_is_an_alarm_and_moves_nothing) {
  Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n", "G27", 0.5, RigKind::blind);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }));
  EXPECT_EQ(rig.alarms(alarm::kThreadNoEncoder), 1) << rig.alarm_list();
  EXPECT_EQ(rig.x(2), 0.0);
}

TEST(ThreadProgram, whose_spindle_is_not_read_any_more_leaves_the_part_with_an_alarm) {
  Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
  rig.drives.spindle_silent = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kThreadMasterLost), 1) << rig.alarm_list();
  EXPECT_EQ(rig.alarm(alarm::kThreadMasterLost)->line, 2);
  EXPECT_NEAR(rig.x(0), 2.0, 1e-6) << "off the part as declared";
  EXPECT_GT(rig.x(2), -15.0);
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, whose_spindle_is_stopped_leaves_the_part_with_an_alarm) {
  Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; }));
  rig.logic.spindle_enable = false;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kThreadMasterTurned) + rig.alarms(alarm::kThreadWindow), 1) << rig.alarm_list();
  EXPECT_NEAR(rig.x(0), 2.0, 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

TEST(ThreadProgram, that_is_too_short_or_too_fast_does_not_begin) {
  for (const bool fast : {true, false}) {
    Rig rig(fast ? "S4000 M3\nG33 Z-100 K9\nM30\n" : "S600 M3\nG33 Z-0.5 K6\nM30\n");
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; })) << fast;
    EXPECT_EQ(rig.alarms(fast ? alarm::kThreadTooFast : alarm::kThreadTooShort), 1) << rig.alarm_list();
    EXPECT_EQ(rig.x(2), 0.0);
  }
}

TEST(TapProgram, goes_to_its_depth_with_the_spindle_and_back_and_the_spindle_turns_as_before) {
  Watched rig("S500 M3\nG0 Z5\nG84 R2 Z-15 K1.5\nX10\nG80\nM30\n", 1.5);
  double deepest = 1e9;
  bool reversed = false;
  const auto watch = rig.each;
  rig.each = [&] {
    watch();
    deepest = std::min(deepest, rig.x(2));
    reversed = reversed || (rig.image().spindles[0].command_rpm < -400.0 && rig.x(2) < -1.0);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  std::printf("tap of a program: deepest %.4f mm, overshoot said %.4f mm\n", deepest,
              rig.process->tap_overshoot());
  EXPECT_TRUE(reversed) << "on the way out";
  EXPECT_NEAR(deepest, -15.0, 0.75);
  EXPECT_NEAR(-15.0 - deepest, rig.process->tap_overshoot(), 1e-6);
  EXPECT_NEAR(rig.x(0), 10.0, 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

/// Watches how far Z parts from the true spindle of a tap, from its lock on until both stand.
struct WatchedTap : Rig {
  WatchedTap(std::string_view program, double lead_mm, std::string_view power_on = "G27",
             std::string_view dialect = "nc110", RigKind kind = RigKind::mill)
      : Rig(program, power_on, 0.5, kind, dialect) {
    each = [this, lead_mm] {
      z_ = {x(2), z_[0], z_[1]};
      deepest = std::min(deepest, x(2));
      if (status().by_spindle && ++behind == 100) at_lock_ = -z_[2] - lead_mm * drives.turns;
      if (!status().by_spindle && !stays()) behind = 0;
      // Out of the hole, whose program goes on, both are free.
      if (!status().by_spindle && state() == ProcessState::running) behind = 0;
      if (behind < 100 || !stays()) return;
      parted = std::max(parted, std::abs(-z_[2] - lead_mm * drives.turns - at_lock_));
    };
  }
  /// Either of them still moves.
  bool stays() const { return moving() || std::abs(image().spindles[0].actual_rpm) > 1.0; }
  bool rests(double patience_s = 20.0) {
    return until([this] { return !stays() && state() != ProcessState::running; }, patience_s);
  }
  double deepest = 1e9, parted = 0.0;
  int behind = 0;

 private:
  std::array<double, 3> z_{};
  double at_lock_ = 0.0;
};

constexpr std::string_view kTap = "S500 M3\nG0 Z5\nG84 R2 Z-25 K1.5\nX10\nG80\nG0 X20\nM30\n";
/// The ramp of the rig's spindle is 50 revolutions/s2.
const double kTapBound = 2.0 * path::phase_bound({0.001, 0.002, 4096.0, 1.0, 50.0}, 1.5);

TEST(TapProgram, stays_with_its_spindle_in_an_emergency_stop_until_both_stand) {
  for (const double z : {-3.0, -12.0, -24.0})
    for (const bool out : {false, true}) {
      WatchedTap rig(kTap, 1.5);
      rig.start();
      ASSERT_TRUE(rig.until([&] {
        const bool there = out ? rig.x(2) > z && rig.image().spindles[0].actual_rpm < -450.0 : rig.x(2) < z;
        return rig.behind > 100 && there;
      }));
      const double then = rig.x(2);
      rig.logic.estop_ok = false;
      ASSERT_TRUE(rig.rests()) << rig.alarm_list();
      EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
      EXPECT_LE(rig.parted, kTapBound) << z << out;
      EXPECT_GT(std::abs(rig.x(2) - then), 0.2) << "it goes along with the ramp";
      EXPECT_FALSE(rig.image().axes[2].drive_command.power) << "and the power goes then";
      EXPECT_EQ(rig.violations(), "");
    }
}

TEST(TapProgram, stays_with_its_spindle_where_a_limit_switch_stops_the_axes) {
  for (const std::size_t axis : {std::size_t{0}, std::size_t{2}}) {
    WatchedTap rig(kTap, 1.5);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -8.0; }));
    rig.logic.limit_plus[axis] = true;
    ASSERT_TRUE(rig.rests()) << rig.alarm_list();
    EXPECT_EQ(rig.state(), ProcessState::stopped_by_alarm);
    EXPECT_LE(rig.parted, kTapBound) << axis;
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(TapProgram, stays_with_its_spindle_where_the_drives_are_switched_off_or_the_program_is_stopped) {
  for (const bool power : {true, false}) {
    WatchedTap rig(kTap, 1.5);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -8.0; }));
    EXPECT_EQ(power ? rig.ask(RequestKind::power, 0.0) : rig.ask(RequestKind::stop), cycle::Refusal::none);
    ASSERT_TRUE(rig.rests()) << rig.alarm_list();
    EXPECT_LE(rig.parted, kTapBound) << power;
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(TapProgram, whose_spindle_coasts_goes_no_deeper_than_it_is_allowed_to) {
  WatchedTap rig(kTap, 1.5);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -8.0; }));
  rig.drives.spindle_coasts = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kTapTooDeep), 1) << rig.alarm_list();
  EXPECT_EQ(rig.alarm(alarm::kTapTooDeep)->line, 4);
  EXPECT_GE(rig.deepest, -25.0 - 3.0 - 1e-6);
  rig.run(1.0);
  EXPECT_EQ(rig.image().spindles[0].command_rpm, 0.0) << "the spindle is told to stop";
  EXPECT_EQ(rig.violations(), "");
}

TEST(TapProgram, goes_with_its_spindle_where_threads_go_by_the_set_point_too) {
  for (const double loses : {0.0, 0.2}) {
    WatchedTap rig(kTap, 1.5, "G27", "nc110", RigKind::setpoint);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -8.0; }));
    rig.drives.slip = loses;
    rig.parted = 0.0;
    ASSERT_TRUE(rig.until([&] { return rig.x(2) > 1.0 && !rig.status().by_spindle; })) << rig.alarm_list();
    EXPECT_LE(rig.parted, 0.15) << "by the set-point it would be " << loses * 15.0 << " mm";
    EXPECT_EQ(rig.violations(), "");
  }
  WatchedTap rig(kTap, 1.5, "G27", "nc110", RigKind::setpoint);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -8.0; }));
  rig.drives.spindle_coasts = true;
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kTapTooDeep), 1) << rig.alarm_list();
  EXPECT_GE(rig.deepest, -25.0 - 3.0 - 1e-6) << "bounded as ever";
}

TEST(TapProgram, whose_spindle_coasts_in_an_emergency_stop_is_bounded_too_and_says_so) {
  WatchedTap rig(kTap, 1.5);
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -20.0; }));
  rig.drives.spindle_coasts = true;
  rig.logic.estop_ok = false;
  ASSERT_TRUE(rig.until([&] { return !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kTapTooDeep), 1) << rig.alarm_list();
  EXPECT_GE(rig.deepest, -25.0 - 3.0 - 1e-6);
  EXPECT_EQ(rig.violations(), "");
}

TEST(TapProgram, whose_spindle_does_not_turn_round_ends_with_an_alarm) {
  WatchedTap rig(kTap, 1.5);
  rig.drives.spindle_one_way = true;
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
  EXPECT_EQ(rig.alarms(alarm::kTapNoTurn), 1) << rig.alarm_list();
  EXPECT_NEAR(rig.x(2), -25.0, 0.75);
}

TEST(TapProgram, that_is_held_leaves_its_hole_first_and_shows_that_it_will_be_held) {
  for (const bool door : {true, false}) {
    WatchedTap rig(kTap, 1.5);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.behind > 100 && rig.x(2) < -8.0; }));
    EXPECT_FALSE(rig.status().holds_later);
    if (door) {
      rig.logic.feed_enable = false;
    } else {
      EXPECT_EQ(rig.ask(RequestKind::hold), cycle::Refusal::none);
    }
    rig.run(0.01);
    EXPECT_TRUE(rig.status().holds_later);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held && !rig.moving(); }))
        << rig.alarm_list();
    EXPECT_FALSE(rig.status().holds_later);
    EXPECT_NEAR(rig.x(2), 2.0, 1e-6);
    EXPECT_NEAR(rig.deepest, -25.0, 0.75) << "the thread is whole";
    rig.logic.feed_enable = true;
    if (!door) {
      EXPECT_EQ(rig.ask(RequestKind::resume), cycle::Refusal::none);
    }
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::ended; })) << rig.alarm_list();
  }
}

TEST(TapProgram, dwells_at_its_depth_with_a_standing_spindle) {
  WatchedTap rig("S500 M3\nG95\nG0 Z5.\nG84 Z-15. R2. P400 F1.5\nG80\nM30\n", 1.5, "G291", "sinumerik-808d");
  int stands = 0;
  const auto watch = rig.each;
  rig.each = [&] {
    watch();
    stands += rig.x(2) < -13.0 && std::abs(rig.image().spindles[0].actual_rpm) < 3.0;
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_GE(stands, 370) << "cycles: 400 from the stop command on, in which the last turn ends, too";
  EXPECT_LE(stands, 600);
  EXPECT_NEAR(rig.deepest, -15.0, 0.75);
  EXPECT_LE(rig.parted, kTapBound);
  EXPECT_EQ(rig.violations(), "");
}

TEST(TapProgram, too_close_to_the_end_of_the_travel_is_refused_before_it_moves) {
  Rig rig("S500 M3\nG0 Z-280\nG84 R-282 Z-298 K1.5\nX10\nG80\nM30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; })) << rig.alarm_list();
  EXPECT_EQ(rig.alarms(cycle::alarm::kProgramError), 1) << rig.alarm_list();
  EXPECT_GE(rig.x(2), -283.0);
}

TEST(ThreadProgram, whose_spindle_is_not_told_to_turn_is_an_alarm_and_moves_nothing) {
  Rig rig("S600 M3\nM5\nG33 Z-60 K1.5\nM30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 5.0));
  EXPECT_EQ(rig.alarms(alarm::kThreadSpindleStands), 1) << rig.alarm_list();
  EXPECT_EQ(rig.x(2), 0.0);
}

TEST(ThreadProgram, whose_spindle_is_not_enabled_waits_and_then_ends_with_an_alarm) {
  Rig rig("S600 M3\nG33 Z-60 K1.5\nM30\n");
  rig.logic.spindle_enable = false;
  rig.start();
  ASSERT_FALSE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 9.0));
  EXPECT_EQ(rig.status().wait.reason, image::WaitReason::spindle_stands);
  ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm; }, 5.0));
  EXPECT_EQ(rig.alarms(alarm::kThreadSpindleStands), 1) << rig.alarm_list();
  EXPECT_EQ(rig.x(2), 0.0);
}

TEST(ThreadProgram, is_left_to_where_its_tool_came_from) {
  struct Case {
    const char* infeed;
    double thread_x, left_x;
  };
  for (const Case& c :
       {Case{"G0 X10\nG0 X5\nG0 X5.1\n", 5.1, 7.1}, Case{"G0 X-10\nG0 X5\nG0 X4.9\n", 4.9, 2.9},
        Case{"G0 X0.1\n", 0.1, 0.1},
        Case{"G0 X10\nG0 X3\nG0 X4\n", 4.0, 2.0}}) {  // into a bore, then a pass into its wall
    Rig rig(std::string("S600 M3\n") + c.infeed + "G33 Z-60 K1.5\nM30\n", "G27", 0.5, RigKind::infeed);
    rig.start();
    ASSERT_TRUE(rig.until([&] { return rig.x(2) < -10.0; })) << rig.alarm_list();
    EXPECT_NEAR(rig.x(0), c.thread_x, 1e-6);
    rig.drives.spindle_silent = true;
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::stopped_by_alarm && !rig.moving(); }));
    EXPECT_NEAR(rig.x(0), c.left_x, 1e-6) << c.infeed;
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(SpindleMark, lets_the_motion_begin_when_the_spindle_passes_its_zero_mark) {
  Rig rig("S60 M3\nG1 X1 F100\nG29\nG1 G35 X5 F1000\nM30\n");
  double began = -1.0;
  rig.each = [&] {
    if (began < 0.0 && rig.x(0) > 1.0 + 1e-9) began = rig.drives.turns - std::floor(rig.drives.turns);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_LT(std::min(began, 1.0 - began), 0.01);
}

}  // namespace
}  // namespace servogate::channel::test
