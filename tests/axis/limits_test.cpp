// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "kernel/axis/axis.hpp"
#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

using test::Judge;
using test::Rig;

TEST(Jog, an_axis_that_is_not_homed_goes_slowly) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(20.0));
  Judge judge(rig.axis.setpoint().x, 0.001);
  while (rig.axis.moving()) rig.cycle(), judge.add(rig.shared().command);
  EXPECT_LE(judge.velocity, 5.0 + 1e-6);
  EXPECT_NEAR(rig.shared().command, 20.0, 1e-9);
}

TEST(Jog, a_homed_axis_goes_at_jog_speed_and_increments_add_up) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(10.0));
  rig.run(20);
  ASSERT_TRUE(rig.axis.jog_increment(10.0));
  Judge judge(rig.axis.setpoint().x, 0.001);
  while (rig.axis.moving()) rig.cycle(), judge.add(rig.shared().command);
  EXPECT_NEAR(judge.velocity, 50.0, 0.5);
  EXPECT_EQ(rig.shared().command, 20.0);
}

TEST(Jog, begins_to_stop_a_tenth_of_a_second_after_the_last_keep_alive) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_continuous(1, rig.image.now.t_ns));
  for (int i = 0; i < 40; ++i) {
    rig.run(50);
    rig.axis.keep_alive(rig.image.now.t_ns);
  }
  const auto last = rig.image.now.t_ns;
  EXPECT_EQ(rig.shared().command_velocity, 50.0);
  ASSERT_TRUE(rig.run_until([&] { return rig.shared().command_velocity < 50.0; }, 200));
  EXPECT_LE(rig.image.now.t_ns - last, 101 * image::kMillisecond);
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }, 500));
}

TEST(Jog, is_given_a_tenth_of_a_second_of_the_wall_clock_where_time_is_scaled) {
  for (const double scale : {20.0, 0.5}) {
    Rig rig;
    rig.reference_here();
    rig.axis.set_time_scale(scale);
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_continuous(1, rig.image.now.t_ns));
    rig.run(static_cast<int>(100.0 * scale) - 2);
    EXPECT_EQ(rig.shared().jog_end, image::JogEnd::none) << scale;
    rig.run(4);
    EXPECT_EQ(rig.shared().jog_end, image::JogEnd::silent) << scale;
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }, 500));
  }
}

TEST(Jog, says_how_it_ended) {
  using image::JogEnd;
  struct Case {
    JogEnd end;
    void (*happens)(Rig&);
  };
  const Case cases[] = {
      {JogEnd::asked, [](Rig& rig) { rig.axis.jog_stop(); }},
      {JogEnd::asked, [](Rig& rig) { rig.axis.stop(); }},
      {JogEnd::feed, [](Rig& rig) { rig.plc("feed_enable", false); }},
      {JogEnd::power, [](Rig& rig) { rig.axis.request_power(false); }},
      {JogEnd::alarm, [](Rig& rig) { rig.reaction = image::Reaction::stop_axes; }},
      {JogEnd::arrived, [](Rig&) {}},
  };
  for (const Case& c : cases) {
    Rig rig;
    rig.reference_here();
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_increment(20.0));
    rig.run(100);
    EXPECT_EQ(rig.shared().jog_end, JogEnd::none);
    c.happens(rig);
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }, 2000));
    EXPECT_EQ(rig.shared().jog_end, c.end) << static_cast<int>(c.end);
  }
}

TEST(Jog, stops_at_the_travel_limit_exactly_whether_continuous_or_by_increment) {
  for (const int direction : {1, -1}) {
    Rig rig;
    rig.reference_here();
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.jog_increment(direction * 1000.0));
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
    EXPECT_EQ(rig.shared().command, direction * 300.0);
    EXPECT_FALSE(rig.axis.jog_increment(direction * 1.0));
    EXPECT_FALSE(rig.axis.jog_continuous(direction, rig.image.now.t_ns));
    ASSERT_TRUE(rig.axis.jog_increment(-direction * 30.0));
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
    ASSERT_TRUE(rig.axis.jog_continuous(direction, rig.image.now.t_ns));
    Judge judge(rig.axis.setpoint().x, 0.001);
    while (rig.axis.moving()) {
      rig.axis.keep_alive(rig.image.now.t_ns);
      rig.cycle();
      judge.add(rig.shared().command);
    }
    EXPECT_EQ(rig.shared().command, direction * 300.0);
    EXPECT_EQ(rig.shared().jog_end, image::JogEnd::travel);
    EXPECT_TRUE(judge.within(rig.axis.config().limits));
    EXPECT_TRUE(rig.events.empty());
  }
}

TEST(Jog, is_stopped_by_the_feed_enable_of_the_plc) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(100.0));
  rig.run(200);
  rig.plc("feed_enable", false);
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }, 500));
  EXPECT_LT(rig.shared().command, 99.0);
  EXPECT_FALSE(rig.axis.jog_increment(1.0));
}

TEST(HardLimit, stops_the_axis_and_lets_it_go_only_back_and_slowly) {
  Rig rig;
  rig.reference_here();
  rig.plus_switch = 100.0;
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(200.0));
  ASSERT_TRUE(rig.run_until([&] { return rig.raised(alarm::kHardLimitPlus); }));
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
  EXPECT_LT(rig.shared().command, 106.0);
  rig.run(50);
  rig.axis.reset();
  EXPECT_EQ(rig.plc("on_limit_plus"), 1.0);
  EXPECT_FALSE(rig.axis.jog_increment(1.0));
  EXPECT_FALSE(rig.axis.jog_continuous(1, rig.image.now.t_ns));
  ASSERT_TRUE(rig.axis.jog_increment(-20.0));
  Judge judge(rig.axis.setpoint().x, 0.001);
  while (rig.axis.moving()) {
    rig.cycle();
    if (rig.axis.on_limit_plus()) judge.add(rig.shared().command);
  }
  EXPECT_LE(judge.velocity, 5.0 + 1e-6);
  EXPECT_EQ(rig.events.size(), 1u);
}

TEST(HardLimit, that_comes_on_while_the_axis_goes_the_other_way_stops_it_too) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  rig.run(200);
  ASSERT_TRUE(rig.axis.jog_increment(-200.0));
  rig.run(400);
  rig.plc("limit_plus", true);  // wires are swapped, or one is broken
  rig.run(2);
  EXPECT_TRUE(rig.raised(alarm::kHardLimitPlus));
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
  EXPECT_GT(rig.shared().command, -30.0);
  rig.run(50);
  rig.axis.reset();
  ASSERT_TRUE(rig.axis.jog_increment(-1.0)) << "away from the switch that is on, it may go";
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
  EXPECT_EQ(rig.events.size(), 1u);
}

TEST(HardLimit, that_bounces_while_the_axis_leaves_it_does_not_stop_it) {
  Rig rig;
  rig.reference_here();
  rig.plc("limit_plus", true);
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.jog_increment(-20.0));
  for (int i = 0; i < 300; ++i) {
    rig.plc("limit_plus", i % 3 == 0);
    rig.cycle();
  }
  rig.plc("limit_plus", false);
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }));
  EXPECT_NEAR(rig.shared().command, -20.0, 1e-9);
  EXPECT_TRUE(rig.events.empty());
}

TEST(HardLimit, is_read_from_the_plc_beside_the_own_input) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  rig.plc("limit_minus", true);
  rig.run(2);
  EXPECT_TRUE(rig.axis.on_limit_minus());
  EXPECT_FALSE(rig.axis.jog_increment(-1.0));
  EXPECT_TRUE(rig.axis.jog_increment(1.0));
}

TEST(HardLimit, both_switches_at_once_are_a_fault_of_the_wiring) {
  Rig rig;
  ASSERT_TRUE(rig.enable());
  rig.plc("limit_minus", true);
  rig.plc("limit_plus", true);
  rig.run(2);
  EXPECT_TRUE(rig.raised(alarm::kBothLimits));
}

TEST(SoftLimit, stops_a_process_that_could_no_longer_stop_before_it) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.acquire(image::AxisOwner::process));
  Ramp path;
  const MotionLimits lim = rig.axis.config().limits;
  path.reset(rig.axis.setpoint(), lim);
  path.move_to(400.0, lim);
  Judge judge(0.0, 0.001);
  for (int i = 0; i < 3000; ++i) {
    const MotionState& s = path.step(0.001);
    if (!rig.axis.stopped_by_reaction())
      rig.setpoint = Setpoint{s.x, s.v, s.a, 0.0};
    else
      rig.setpoint.reset();
    rig.cycle();
    judge.add(rig.shared().command);
  }
  EXPECT_TRUE(rig.raised(alarm::kSoftLimitPlus));
  EXPECT_EQ(rig.events[0].limit, 300.0);
  EXPECT_LE(rig.shared().command, 300.5);
  EXPECT_TRUE(judge.within(lim));
}

TEST(SoftLimit, says_nothing_of_a_process_that_brakes_at_the_limit_itself) {
  Rig rig;
  rig.reference_here();
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.acquire(image::AxisOwner::process));
  Ramp path;
  path.reset(rig.axis.setpoint(), rig.axis.config().limits);
  path.move_to(300.0, rig.axis.config().limits);
  while (!path.done()) {
    const MotionState& s = path.step(0.001);
    rig.setpoint = Setpoint{s.x, s.v, s.a, 0.0};
    rig.cycle();
  }
  EXPECT_TRUE(rig.events.empty());
  EXPECT_EQ(rig.shared().command, 300.0);
}

TEST(Axis, keeps_its_limits_whatever_is_asked_of_it_at_any_time) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  long cycles = 0;
  for (int run = 0; run < 60; ++run) {
    AxisConfig c = test::mill_axis();
    c.limits = {20 + 480 * unit(random), 100 + 4900 * unit(random), 1000 + 99'000 * unit(random)};
    c.jog_velocity = c.limits.velocity;
    c.following_error_limit = 1e9;
    c.feedback_delay = 1 + static_cast<int>(unit(random) * 6);
    Rig rig(c);
    rig.reference_here();
    rig.drive.lag = 0.5 * unit(random);
    ASSERT_TRUE(rig.enable());
    Judge judge(rig.axis.setpoint().x, 0.001);
    for (int order = 0; order < 200; ++order) {
      const double kind = unit(random);
      const int direction = unit(random) < 0.5 ? 1 : -1;
      if (kind < 0.35)
        rig.axis.jog_increment(direction * std::pow(10.0, unit(random) * 6 - 3));
      else if (kind < 0.6)
        rig.axis.jog_continuous(direction, rig.image.now.t_ns);
      else if (kind < 0.7)
        rig.axis.jog_stop();
      else if (kind < 0.75)
        rig.plc("feed_enable", false);
      else if (kind < 0.8)
        rig.reaction = image::Reaction::stop_axes;
      else if (kind < 0.85)
        rig.axis.move_to(600 * unit(random) - 300, 500 * unit(random));
      else if (kind < 0.95)
        rig.axis.keep_alive(rig.image.now.t_ns);
      for (int k = static_cast<int>(unit(random) * 150); k >= 0; --k, ++cycles) {
        rig.cycle();
        judge.add(rig.shared().command);
        ASSERT_LE(std::abs(rig.shared().command), 300.0 + 1e-9) << "run " << run;
      }
      if (unit(random) < 0.5) {
        rig.plc("feed_enable", true);
        rig.reaction = image::Reaction::none;
      }
    }
    ASSERT_TRUE(judge.within(c.limits)) << "run " << run;
    ASSERT_TRUE(rig.events.empty()) << rig.events[0].number;
  }
  EXPECT_GT(cycles, 500'000);
}

}  // namespace
}  // namespace servogate::axis
