// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/axis.hpp"

#include <gtest/gtest.h>

#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

using image::AxisOwner;
using test::Judge;
using test::Rig;

TEST(CountScale, gives_every_count_back_over_the_whole_range_of_64_bits_without_drift) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_int_distribution<std::int64_t> ratio(1, 1'000'000),
      counts(-4'000'000'000'000, 4'000'000'000'000);
  for (int i = 0; i < 200'000; ++i) {
    const std::int64_t reference = counts(random) * 100;
    const CountScale s{ratio(random), ratio(random) % 1000 + 1, i % 2 ? 1 : -1, reference, -12.5};
    const std::int64_t c = reference + counts(random) / 1000;
    ASSERT_EQ(s.counts(s.position(c)), c) << s.numerator << "/" << s.denominator;
  }
}

TEST(CountScale, rounds_to_the_nearest_count_with_an_exact_ratio) {
  const CountScale s{131072, 5, 1, 0, 0.0};  // 26214.4 counts a mm
  EXPECT_EQ(s.counts(1.0), 26214);
  EXPECT_EQ(s.counts(5.0), 131072);
  EXPECT_EQ(s.counts(-1.0), -26214);
  EXPECT_EQ(s.position(131072), 5.0);
  EXPECT_NEAR(s.velocity(26214.4), 1.0, 1e-12);
}

TEST(Axis, follows_the_feedback_while_it_is_off_and_never_jumps_when_the_drive_comes_on) {
  Rig rig;
  rig.drive.start_at(12'345);
  rig.run(10);
  EXPECT_EQ(rig.shared().drive_command.position_counts, 12'345);
  EXPECT_NEAR(rig.shared().command, 12.345, 1e-12);
  for (int i = 0; i < 100; ++i) {  // dragged by hand
    rig.drive.counts += 37;
    rig.cycle();
    ASSERT_EQ(rig.shared().drive_command.position_counts, rig.drive.counts);
  }
  rig.axis.request_power(true);
  for (int i = 0; i < 100; ++i) {
    rig.cycle();
    ASSERT_EQ(rig.shared().drive_command.position_counts, rig.drive.counts);
    ASSERT_EQ(rig.shared().following_error, 0.0);
  }
  EXPECT_TRUE(rig.shared().enabled);
  EXPECT_EQ(rig.plc("enabled"), 1.0);
}

TEST(Axis, needs_the_permission_of_the_plc_and_the_operators_wish_for_power) {
  Rig rig;
  rig.run(20);
  EXPECT_FALSE(rig.shared().drive_command.power);
  rig.axis.request_power(true);
  rig.plc("enable", false);
  rig.run(20);
  EXPECT_FALSE(rig.shared().drive_command.power);
  rig.plc("enable", true);
  rig.power_on(false);
  rig.run(20);
  EXPECT_FALSE(rig.shared().drive_command.power);
  rig.power_on(true);
  rig.run(20);
  EXPECT_TRUE(rig.shared().enabled);
}

TEST(Axis, sees_no_following_error_at_equal_times_behind_any_delay_of_the_drive) {
  for (int delay = 1; delay <= 15; ++delay) {
    AxisConfig c = test::mill_axis();
    c.feedback_delay = delay;
    c.slow_velocity = 500.0, c.jog_velocity = 500.0;
    Rig rig(c);
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_increment(200.0));
    while (rig.axis.moving()) {
      rig.cycle();
      ASSERT_LE(std::abs(rig.shared().following_error), 0.00051) << "delay " << delay;  // half a count
    }
  }
}

TEST(Axis, reports_a_following_error_with_limit_value_and_velocity) {
  AxisConfig c = test::mill_axis();
  c.slow_velocity = c.jog_velocity = 100.0;
  Rig rig(c);
  rig.drive.lag = 0.97;  // about 32 ms behind: 3.2 mm at 100 mm/s
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(100.0));
  ASSERT_TRUE(rig.run_until([&] { return !rig.events.empty(); }));
  EXPECT_EQ(rig.events[0].number, alarm::kFollowingError);
  EXPECT_EQ(rig.events[0].limit, 1.0);
  EXPECT_GT(rig.events[0].value, 1.0);
  EXPECT_LT(rig.events[0].value, 1.1);
  EXPECT_GT(rig.events[0].detail1, 5.0);
  EXPECT_TRUE(rig.axis.present(alarm::kFollowingError));
  rig.reaction = image::Reaction::stop_axes;
  rig.run(1000);
  EXPECT_FALSE(rig.axis.present(alarm::kFollowingError));
  EXPECT_EQ(rig.events.size(), 1u) << "raised once, however long it lasts";
}

TEST(Axis, warns_once_each_time_that_the_following_error_exceeds_its_warning) {
  AxisConfig c = test::mill_axis();
  c.slow_velocity = c.jog_velocity = 100.0;
  c.following_error_limit = 10.0;
  c.following_error_warn = 2.0;
  Rig rig(c);
  rig.drive.lag = 0.97;  // about 32 ms behind: 3.2 mm at 100 mm/s
  ASSERT_TRUE(rig.enable());
  for (std::size_t exceedance = 1; exceedance <= 3; ++exceedance) {
    ASSERT_TRUE(rig.axis.jog_increment(exceedance % 2 != 0 ? 100.0 : -100.0));
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
    rig.run(500);
    ASSERT_EQ(rig.events.size(), exceedance);
    const Event& e = rig.events.back();
    EXPECT_EQ(e.number, alarm::kFollowingErrorHigh);
    EXPECT_EQ(e.limit, 2.0);
    EXPECT_GT(std::abs(e.value), 2.0);
    EXPECT_LT(std::abs(e.value), 2.2);
    EXPECT_GT(std::abs(e.detail1), 50.0) << "with the speed";
  }
  EXPECT_FALSE(rig.axis.stopped_by_reaction());
}

TEST(Axis, warns_of_no_following_error_that_the_speed_allows_and_never_where_no_warning_is_asked_for) {
  for (const double warn : {0.0, 2.0}) {
    AxisConfig c = test::mill_axis();
    c.slow_velocity = c.jog_velocity = 100.0;
    c.following_error_limit = 10.0;
    c.following_error_warn = warn;
    c.following_error_velocity = warn > 0.0 ? 0.04 : 0.0;  // the lag is 0.032 mm for each mm/s
    Rig rig(c);
    rig.drive.lag = 0.97;
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_increment(100.0));
    double most = 0.0;
    ASSERT_TRUE(rig.run_until([&] {
      most = std::max(most, std::abs(rig.shared().following_error));
      return !rig.axis.moving();
    }));
    EXPECT_GT(most, 3.0);
    EXPECT_TRUE(rig.events.empty()) << warn;
  }
}

TEST(Axis, permits_more_following_error_at_speed_where_the_machine_file_says_so) {
  for (const bool allowed : {false, true}) {
    AxisConfig c = test::mill_axis();
    c.slow_velocity = c.jog_velocity = 100.0;
    c.following_error_limit = 1.2;
    c.following_error_velocity = allowed ? 0.04 : 0.0;  // the lag below is 0.032 mm for each mm/s
    Rig rig(c);
    rig.drive.lag = 0.97;
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_increment(100.0));
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
    EXPECT_EQ(rig.raised(alarm::kFollowingError), !allowed);
  }
}

TEST(Axis, goes_back_to_nobody_as_soon_as_it_stands_when_its_process_lets_go_in_motion) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.acquire(AxisOwner::process));
  rig.setpoint = Setpoint{0.001, 1.0, 0.0, 0.0};
  rig.cycle();
  EXPECT_FALSE(rig.axis.release(AxisOwner::process));
  EXPECT_EQ(rig.axis.owner(), AxisOwner::process);
  rig.setpoint = Setpoint{0.002, 0.0, 0.0, 0.0};
  rig.cycle();
  rig.setpoint.reset();
  rig.run(2);
  EXPECT_EQ(rig.axis.owner(), AxisOwner::none);
}

TEST(Axis, is_in_position_only_after_the_time_inside_the_window) {
  Rig rig;
  rig.drive.lag = 0.9;
  ASSERT_TRUE(rig.enable());
  rig.run(30);
  EXPECT_TRUE(rig.shared().in_position);
  ASSERT_TRUE(rig.axis.jog_increment(1.0));
  rig.cycle();
  EXPECT_FALSE(rig.shared().in_position);
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
  int inside = 0, cycles = 0;
  while (!rig.shared().in_position && cycles++ < 1000) {
    rig.cycle();
    if (std::abs(rig.shared().command - rig.shared().actual) <= 0.01) ++inside;
  }
  EXPECT_GE(inside, 9);  // the first one was the cycle in which it stopped
  EXPECT_LE(inside, 10);
}

TEST(Axis, says_that_it_does_not_come_into_position) {
  AxisConfig c = test::mill_axis();
  c.in_position_timeout = 0.5;
  Rig rig(c);
  ASSERT_TRUE(rig.enable());
  rig.drive.lag = 0.9999;
  ASSERT_TRUE(rig.axis.jog_increment(0.5));
  ASSERT_TRUE(rig.run_until([&] { return rig.raised(alarm::kInPositionTimeout); }, 3000));
  EXPECT_GT(std::abs(rig.events[0].value), 0.01);
  EXPECT_EQ(rig.events[0].limit, 0.01);
}

TEST(Axis, has_one_owner_and_hands_over_at_standstill_only) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(5.0));
  rig.run(10);
  EXPECT_EQ(rig.axis.owner(), AxisOwner::manual);
  EXPECT_EQ(rig.plc("owner"), 2.0);
  EXPECT_FALSE(rig.axis.acquire(AxisOwner::process));
  EXPECT_FALSE(rig.axis.release(AxisOwner::manual));
  EXPECT_FALSE(rig.axis.home());
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
  EXPECT_EQ(rig.axis.owner(), AxisOwner::none);
  EXPECT_TRUE(rig.axis.acquire(AxisOwner::process));
  EXPECT_FALSE(rig.axis.release(AxisOwner::plc));
  EXPECT_TRUE(rig.axis.release(AxisOwner::process));
}

TEST(Axis, follows_its_process_exactly) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.acquire(AxisOwner::process));
  Ramp path;
  path.reset(rig.axis.setpoint(), rig.axis.config().limits);
  path.move_to(250.0, rig.axis.config().limits);
  while (!path.done()) {
    const MotionState& s = path.step(0.001);
    rig.setpoint = Setpoint{s.x, s.v, s.a, 250.0 - s.x};
    rig.cycle();
    ASSERT_EQ(rig.shared().command, s.x);
    ASSERT_EQ(rig.shared().drive_command.position_counts, std::llround(s.x * 1000.0));
  }
  EXPECT_TRUE(rig.events.empty());
}

TEST(Axis, refuses_a_step_of_its_process_and_stops_within_its_limits) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.acquire(AxisOwner::process));
  const double at = rig.axis.setpoint().x;
  rig.setpoint = Setpoint{at + 5.0, 0.0, 0.0, 0.0};
  rig.cycle();
  EXPECT_TRUE(rig.raised(alarm::kSetpointStep));
  EXPECT_EQ(rig.shared().command, at);
}

TEST(Axis, stops_at_its_own_limits_when_its_process_falls_silent_in_motion_or_a_reaction_asks) {
  for (const bool by_reaction : {false, true}) {
    Rig rig;
    rig.reference_here();
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.acquire(AxisOwner::process));
    Ramp path;
    path.reset(rig.axis.setpoint(), rig.axis.config().limits);
    path.move_to(250.0, rig.axis.config().limits);
    Judge judge(rig.axis.setpoint().x, 0.001);
    for (int i = 0; i < 400; ++i) {
      const MotionState& s = path.step(0.001);
      rig.setpoint = Setpoint{s.x, s.v, s.a, 0.0};
      rig.cycle();
      judge.add(rig.shared().command);
    }
    const double way = Ramp::stopping_distance(path.state(), rig.axis.config().limits);
    const double from = path.state().x;
    if (by_reaction)
      rig.reaction = image::Reaction::stop_axes;
    else
      rig.setpoint.reset();
    for (int i = 0; i < 1000; ++i) {
      rig.cycle();
      judge.add(rig.shared().command);
    }
    EXPECT_TRUE(judge.within(rig.axis.config().limits));
    EXPECT_NEAR(rig.shared().command, from + way, 1e-6);
    EXPECT_FALSE(rig.axis.moving());
  }
}

TEST(Axis, tells_what_the_drive_did_when_it_fails) {
  {
    Rig rig;
    ASSERT_TRUE(rig.enable());
    rig.drive.fault = true;
    rig.shared().drive.error_code = 0x8611;
    rig.run(3);
    EXPECT_TRUE(rig.raised(alarm::kDriveFault));
    EXPECT_FALSE(rig.raised(alarm::kPowerLostInMotion)) << "the fault says it all";
    EXPECT_FALSE(rig.shared().drive_command.power) << "nothing comes on again unasked";
    rig.axis.reset();
    rig.run(5);
    EXPECT_FALSE(rig.drive.fault);
    EXPECT_FALSE(rig.axis.present(alarm::kDriveFault));
    rig.run(100);
    EXPECT_FALSE(rig.shared().enabled);
    EXPECT_TRUE(rig.enable());
  }
  {
    Rig rig;
    ASSERT_TRUE(rig.enable());
    rig.drive.enable_cycles = 1'000'000;
    rig.run(3);
    EXPECT_TRUE(rig.raised(alarm::kPowerLostInMotion));
  }
  {
    Rig rig;
    rig.reference_here();
    rig.drive.lost = false;
    rig.run(3);
    rig.drive.lost = true;
    rig.run(3);
    EXPECT_TRUE(rig.raised(alarm::kDriveOffline));
    EXPECT_FALSE(rig.axis.homed()) << "an incremental encoder is not trusted after that";
  }
  {
    Rig rig;
    ASSERT_TRUE(rig.enable());
    rig.drive.mute = true;
    rig.run(3);
    EXPECT_TRUE(rig.raised(alarm::kPdoMissing));
  }
  {
    Rig rig;
    rig.shared().drive.refusal = {image::DriveState::ready_to_switch_on, image::DriveState::switched_on, 500};
    rig.run(1);
    EXPECT_TRUE(rig.raised(alarm::kDriveRefuses));
  }
}

TEST(Axis, whose_drive_is_not_enabled_tells_whether_it_is_the_mode_that_is_missing) {
  const auto awaited = [](image::DriveState from, image::DriveState wanted, image::DriveMode shown) {
    Rig rig;
    rig.shared().drive.refusal = {from, wanted, 2000};
    rig.shared().drive.mode = shown;
    rig.run(1);
    for (const Event& e : rig.events)
      if (e.number == alarm::kDriveRefuses) return e.detail2;
    return -1.0;
  };
  using enum image::DriveState;
  EXPECT_EQ(awaited(switched_on, operation_enabled, image::DriveMode::none), 1.0);
  EXPECT_EQ(awaited(switched_on, operation_enabled, image::DriveMode::homing), 1.0);
  EXPECT_EQ(awaited(switched_on, operation_enabled, image::DriveMode::csp), 0.0);
  EXPECT_EQ(awaited(ready_to_switch_on, switched_on, image::DriveMode::none), 0.0);
}

TEST(Axis, whose_process_data_do_not_come_is_not_said_to_fall_behind_or_to_stand) {
  AxisConfig config = test::mill_axis();
  config.missed_limit = 5;
  config.following_error_warn = 0.006;
  config.following_error_limit = 0.012;
  Rig rig(config);
  ASSERT_TRUE(rig.enable());
  rig.axis.jog_increment(200.0);
  rig.run(800);
  const double speed = rig.shared().command_velocity;
  ASSERT_GT(speed, 4.0) << "two cycles of it are more than the warning";
  for (int missing = 1; missing < 5; ++missing) {
    rig.drive.mute = true;
    rig.run(missing);
    rig.drive.mute = false;
    rig.run(50);
  }
  EXPECT_TRUE(rig.events.empty()) << rig.events.front().number;
  rig.drive.mute = true;
  rig.run(5);
  ASSERT_FALSE(rig.events.empty());
  EXPECT_EQ(rig.events.front().number, alarm::kPdoMissing) << "the cause comes first";
  rig.drive.mute = false;
  rig.drive.lost = true;
  rig.run(1);
  EXPECT_EQ(rig.events.back().number, alarm::kDriveOffline);
  EXPECT_NEAR(rig.events.back().detail1, speed, 0.1 * speed);
}

TEST(Axis, notices_a_jump_of_the_encoder_and_is_not_homed_any_more) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  rig.drive.delay = 1;
  rig.drive.counts += 2'000'000;
  rig.before_command = [] {};
  rig.shared().drive.position_counts = 0;
  rig.image.now.t_ns += rig.image.now.period_ns;
  image::DriveFeedback jumped = rig.shared().drive;
  jumped.position_counts += 50'000;
  rig.shared().drive = jumped;
  rig.axis.read(rig.image);
  ASSERT_EQ(rig.axis.events().size(), 2);  // and the following error that comes of it
  EXPECT_EQ(rig.axis.events().begin()->number, alarm::kEncoderJump);
  EXPECT_FALSE(rig.axis.homed());
}

TEST(Axis, stops_before_it_goes_off_when_the_plc_takes_the_enable_away_in_motion) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(50.0));
  Judge judge(rig.axis.setpoint().x, 0.001);
  for (int i = 0; i < 300; ++i) rig.cycle(), judge.add(rig.shared().command);
  rig.plc("enable", false);
  double last_v = 5.0;
  while (rig.shared().drive_command.power) {
    rig.cycle();
    judge.add(rig.shared().command);
    last_v = rig.shared().command_velocity;
  }
  EXPECT_EQ(last_v, 0.0);
  EXPECT_TRUE(rig.raised(alarm::kEnableWithdrawn));
  EXPECT_TRUE(judge.within(rig.axis.config().limits));
}

TEST(Axis, says_nothing_of_an_enable_that_goes_together_with_the_power) {
  for (const image::Reaction reaction : {image::Reaction::quick_stop, image::Reaction::power_off}) {
    Rig rig;
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_increment(50.0));
    rig.run(300);
    rig.reaction = reaction;  // emergency stop: the alarm stands, and the PLC takes the enable away
    rig.plc("enable", false);
    rig.run(500);
    EXPECT_FALSE(rig.raised(alarm::kEnableWithdrawn));
    EXPECT_FALSE(rig.shared().drive_command.power);
  }
}

}  // namespace
}  // namespace servogate::axis
