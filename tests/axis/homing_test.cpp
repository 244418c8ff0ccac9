// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "kernel/axis/homing_sequence.hpp"
#include "tests/axis/rig.hpp"

namespace servogate::axis {
namespace {

using test::Rig;

/// Homes a rig whose slide stands at `start_mm`; the counts that were captured.
std::int64_t home_from(const AxisConfig& config, double start_mm, Rig* given = nullptr) {
  Rig own(config);
  Rig& rig = given != nullptr ? *given : own;
  rig.drive.start_at(std::llround(start_mm * 1000.0) * config.count_direction);
  EXPECT_TRUE(rig.enable()) << start_mm;
  EXPECT_TRUE(rig.axis.home()) << start_mm;
  test::Judge judge(rig.axis.setpoint().x, 0.001);
  EXPECT_TRUE(rig.run_until([&] {
    if (rig.axis.homing().state() == Homing::State::final_move && !config.homing.final_move)
      judge.seat(rig.axis.setpoint().x);
    else if (!rig.axis.homed())
      judge.add(rig.axis.setpoint().x);
    return !rig.axis.homing().active();
  })) << start_mm;
  EXPECT_EQ(rig.axis.homing().state(), Homing::State::done)
      << start_mm << " failure " << rig.axis.homing().failure();
  EXPECT_TRUE(judge.within(config.limits)) << start_mm;
  EXPECT_TRUE(rig.axis.homed());
  EXPECT_TRUE(rig.events.empty()) << rig.events.front().number;
  return rig.axis.reference_counts();
}

TEST(Homing, lands_on_the_same_index_from_a_thousand_random_starts) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-309.0, 309.0);
  for (const int release : {-1, 1}) {
    AxisConfig config = test::mill_axis();
    config.homing.release_direction = release;
    // decisive edge at -250 mm; marks at 1.234 mm + n * 5 mm
    const std::int64_t expected = release > 0 ? -248'766 : -253'766;
    for (int i = 0; i < 500; ++i)
      ASSERT_EQ(home_from(config, start(random)), expected) << "release " << release;
  }
}

TEST(Homing, finds_the_index_behind_a_narrow_switch_in_the_middle_of_the_travel) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-309.0, 309.0);
  for (const int release : {-1, 1})
    for (int i = 0; i < 100; ++i) {
      AxisConfig config = test::mill_axis();
      config.homing.release_direction = release;
      Rig rig(config);
      rig.home_from = 10.0;
      rig.home_to = 7.5;  // overrun by the stop of the fast search (about 3 mm)
      // driving onto it from above: edge at 10, next mark below is 6.234; leaving upwards: 11.234
      ASSERT_EQ(home_from(config, start(random), &rig), release < 0 ? 6'234 : 11'234);
    }
}

TEST(Homing, works_alike_towards_the_positive_end_with_a_lagging_drive_and_a_bouncing_switch) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-309.0, 309.0), lag(0.0, 0.9);
  for (const int release : {-1, 1})
    for (int i = 0; i < 100; ++i) {
      AxisConfig config = test::mill_axis();
      config.homing.direction = 1;
      config.homing.release_direction = release;
      config.following_error_limit = 5.0;
      Rig rig(config);
      rig.home_from = 1e9;
      rig.home_to = 250.0;
      rig.drive.lag = lag(random);
      rig.bounce_cycles = 9;
      // marks at 1.234 mm + n * 5 mm: the first beyond 250 is 251.234, the first below it 246.234
      ASSERT_EQ(home_from(config, start(random), &rig), release > 0 ? 251'234 : 246'234);
    }
}

TEST(Homing, warns_when_the_zero_mark_lies_so_near_the_edge_that_the_next_one_may_be_taken) {
  for (const auto& [mark, warns] : {std::pair{100, true}, {2500, false}, {4900, true}}) {
    AxisConfig config = test::mill_axis();
    config.homing.index_spacing = 5.0;
    Rig rig(config);
    rig.drive.mark = mark;  // counts behind the edge at -250 mm
    ASSERT_TRUE(rig.enable());
    ASSERT_TRUE(rig.axis.home());
    ASSERT_TRUE(rig.run_until([&] { return !rig.axis.homing().active(); }));
    EXPECT_TRUE(rig.axis.homed());
    EXPECT_EQ(rig.raised(alarm::kHomingIndexNearEdge), warns) << mark;
  }
}

TEST(Homing, works_alike_with_counts_that_fall) {
  AxisConfig config = test::mill_axis();
  config.count_direction = -1;
  const std::int64_t captured = home_from(config, 17.0);
  // marks at counts 1234 + n * 5000, the first at or above -250 mm (counts 250000 downwards): 246234
  EXPECT_EQ(captured, 246'234);
}

TEST(Homing, sets_the_machine_position_so_that_the_captured_count_is_the_home_position) {
  AxisConfig config = test::mill_axis();
  Rig rig(config);
  home_from(config, 40.0, &rig);
  EXPECT_DOUBLE_EQ(rig.axis.scale().position(rig.axis.reference_counts()), -251.0);
  EXPECT_NEAR(rig.axis.actual(), rig.true_mm() + 248.766 - 251.0, 1e-9);
  EXPECT_NEAR(rig.axis.setpoint().x, rig.axis.actual(), 0.001);
}

TEST(Homing, moves_to_the_final_position_at_the_end) {
  AxisConfig config = test::mill_axis();
  config.homing.final_move = true;
  config.homing.final_position = -200.0;
  Rig rig(config);
  home_from(config, 40.0, &rig);
  rig.run(20);
  EXPECT_NEAR(rig.axis.actual(), -200.0, 0.001);
  EXPECT_EQ(rig.axis.owner(), image::AxisOwner::none);
}

TEST(Homing, keeps_the_drive_still_while_the_machine_position_is_set) {
  Rig rig(test::mill_axis());
  rig.drive.start_at(50'000);
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.home());
  std::int64_t last = 0;
  while (rig.axis.homing().active()) {
    last = rig.shared().drive_command.position_counts;
    rig.cycle();
  }
  EXPECT_EQ(rig.shared().drive_command.position_counts, last);
  EXPECT_LT(std::abs(rig.axis.following_error()), 0.0011);
}

TEST(Homing, on_the_switch_alone_repeats_within_one_cycle_of_the_slow_speed) {
  std::mt19937_64 random(test::fresh_seed());
  std::uniform_real_distribution<double> start(-309.0, 309.0);
  AxisConfig config = test::mill_axis();
  config.homing.method = HomingMethod::switch_only;
  std::int64_t low = 1'000'000'000, high = -low;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t c = home_from(config, start(random));
    low = std::min(low, c), high = std::max(high, c);
  }
  EXPECT_GE(low, -250'000);
  EXPECT_LE(high, -250'000 + 4);  // 3 mm/s, 1 ms, 1000 counts/mm
}

TEST(Homing, on_the_index_alone_takes_the_next_one_in_the_direction_of_search) {
  AxisConfig config = test::mill_axis();
  config.homing.method = HomingMethod::index_only;
  EXPECT_EQ(home_from(config, 40.0), 36'234);
}

TEST(Homing, an_absolute_axis_without_a_kept_reference_says_so_and_with_one_is_homed_at_once) {
  AxisConfig config = test::mill_axis();
  config.homing.method = HomingMethod::absolute;
  Rig rig(config);
  ASSERT_TRUE(rig.enable());
  EXPECT_TRUE(rig.axis.home());
  rig.run(5);
  EXPECT_TRUE(rig.raised(alarm::kHomingNoReference));
  EXPECT_FALSE(rig.axis.homed());
  rig.axis.configure(config, 0);
  rig.axis.set_reference(777);
  ASSERT_TRUE(rig.enable());
  EXPECT_TRUE(rig.axis.homed());
  EXPECT_TRUE(rig.axis.home());
  rig.run(2);
  EXPECT_EQ(rig.axis.reference_counts(), 777);
}

struct Failure {
  const char* name;
  image::AlarmNumber number;
  std::function<void(AxisConfig&)> configure;
  std::function<void(Rig&)> prepare;
};

class HomingFailure : public ::testing::TestWithParam<Failure> {};

TEST_P(HomingFailure, is_named_and_the_axis_stops_within_its_limits) {
  AxisConfig config = test::mill_axis();
  GetParam().configure(config);
  Rig rig(config);
  GetParam().prepare(rig);
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.home());
  test::Judge judge(rig.axis.setpoint().x, 0.001);
  ASSERT_TRUE(rig.run_until([&] {
    judge.add(rig.axis.setpoint().x);
    return !rig.axis.homing().active() && !rig.axis.moving();
  }));
  EXPECT_TRUE(judge.within(config.limits));
  EXPECT_EQ(rig.axis.homing().failure(), GetParam().number);
  ASSERT_EQ(rig.events.size(), 1u);
  EXPECT_EQ(rig.events[0].number, GetParam().number);
  EXPECT_FALSE(rig.axis.homed());
}

const Failure kFailures[] = {
    {"switch_not_found", alarm::kHomingSwitchNotFound, [](AxisConfig& c) { c.homing.max_travel = 100; },
     [](Rig&) {}},
    {"switch_not_released", alarm::kHomingSwitchNotReleased, [](AxisConfig& c) { c.homing.max_travel = 20; },
     [](Rig& r) { r.home_from = 1e9; }},
    {"index_not_found", alarm::kHomingIndexNotFound, [](AxisConfig&) {},
     [](Rig& r) { r.drive.revolution = 1'000'000'000; }},
    {"time_out", alarm::kHomingTimeout, [](AxisConfig& c) { c.homing.timeout_s = 2.0; }, [](Rig&) {}},
    {"no_switch_between_both_limits", alarm::kHomingLimitAgain, [](AxisConfig&) {},
     [](Rig& r) { r.home_from = -1e9; }},
};
INSTANTIATE_TEST_SUITE_P(All, HomingFailure, ::testing::ValuesIn(kFailures),
                         [](const auto& which) { return std::string(which.param.name); });

TEST(Homing, is_broken_off_by_a_reaction_and_says_so) {
  Rig rig(test::mill_axis());
  ASSERT_TRUE(rig.enable());
  ASSERT_TRUE(rig.axis.home());
  rig.run(500);
  rig.reaction = image::Reaction::stop_on_path;
  ASSERT_TRUE(rig.run_until([&] { return !rig.axis.moving(); }, 1000));
  EXPECT_TRUE(rig.raised(alarm::kHomingInterrupted));
  EXPECT_FALSE(rig.axis.homed());
}

TEST(HomingSequence, homes_axes_of_the_same_number_together_and_higher_numbers_later) {
  std::array<Axis, 3> axes;
  std::array<test::FakeDrive, 3> drives;
  image::ProcessImage image;
  image.axis_count = 3;
  image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
  for (int i = 0; i < 3; ++i) {
    AxisConfig c = test::mill_axis();
    c.limit_plus.reset(), c.limit_minus.reset(), c.home_switch.reset();
    c.homing.order = i == 2 ? 1 : 2;
    axes[static_cast<std::size_t>(i)].configure(c, i);
    axes[static_cast<std::size_t>(i)].request_power(true);
    for (auto p :
         {image::field(image::kAxisFields, "enable"), image::field(image::kAxisFields, "feed_enable")})
      image.packets.set_bit(image::at(p, image::axis_base(i)), true);
  }
  HomingSequence sequence;
  int third_done = 0, first_begun = 0, second_begun = 0;
  for (int k = 0; k < 60'000 && sequence.state() != HomingSequence::State::done; ++k) {
    image.now.t_ns += image.now.period_ns;
    for (std::size_t i = 0; i < 3; ++i) {
      drives[i].cycle(image.axes[i].drive_command, image.axes[i].drive);
      image.packets.set_bit(
          image::at(image::field(image::kAxisFields, "home_switch"), image::axis_base(static_cast<int>(i))),
          drives[i].counts < -20'000);
      axes[i].read(image);
    }
    if (k == 100) {
      ASSERT_TRUE(sequence.start(axes, 0b111));
      EXPECT_FALSE(sequence.start(axes, 0b111));
    }
    sequence.step(axes);
    for (Axis& a : axes) a.command(image);
    if (third_done == 0 && axes[2].homed()) third_done = k;
    if (first_begun == 0 && axes[0].homing().active()) first_begun = k;
    if (second_begun == 0 && axes[1].homing().active()) second_begun = k;
  }
  EXPECT_EQ(sequence.state(), HomingSequence::State::done);
  EXPECT_GT(third_done, 100);
  EXPECT_GE(first_begun, third_done);
  EXPECT_EQ(first_begun, second_begun);
  for (const Axis& a : axes) EXPECT_TRUE(a.homed());
}

TEST(HomingSequence, ends_with_the_first_failure_and_stops_the_axes_under_way) {
  std::array<Axis, 3> axes;
  std::array<test::FakeDrive, 3> drives;
  image::ProcessImage image;
  image.axis_count = 3;
  image.packets.set_bit(image::field(image::kMachineFields, "power_on", image::kMachineBase), true);
  for (int i = 0; i < 3; ++i) {
    AxisConfig c = test::mill_axis();
    c.limit_plus.reset(), c.limit_minus.reset(), c.home_switch.reset();
    c.homing.order = i == 2 ? 2 : 1;
    c.homing.max_travel = i == 0 ? 10.0 : 1000.0;
    axes[static_cast<std::size_t>(i)].configure(c, i);
    axes[static_cast<std::size_t>(i)].request_power(true);
    for (auto p :
         {image::field(image::kAxisFields, "enable"), image::field(image::kAxisFields, "feed_enable")})
      image.packets.set_bit(image::at(p, image::axis_base(i)), true);
  }
  HomingSequence sequence;
  for (int k = 0; k < 5'000; ++k) {
    image.now.t_ns += image.now.period_ns;
    for (std::size_t i = 0; i < 3; ++i) {
      drives[i].cycle(image.axes[i].drive_command, image.axes[i].drive);
      axes[i].read(image);
    }
    if (k == 100) {
      ASSERT_TRUE(sequence.start(axes, 0b111));
    }
    sequence.step(axes);
    for (Axis& a : axes) a.command(image);
  }
  EXPECT_EQ(sequence.state(), HomingSequence::State::failed);
  EXPECT_EQ(axes[0].homing().failure(), alarm::kHomingSwitchNotFound);
  EXPECT_EQ(axes[1].homing().state(), Homing::State::idle);
  EXPECT_EQ(axes[2].setpoint().x, 0.0) << "its turn never came";
  for (const Axis& a : axes) EXPECT_TRUE(a.standstill());
}

TEST(HomingSequence, does_not_begin_while_one_of_the_axes_is_without_power) {
  std::array<Axis, 2> axes;
  HomingSequence sequence;
  EXPECT_FALSE(sequence.start(axes, 0b11));
  EXPECT_EQ(sequence.state(), HomingSequence::State::idle);
}

}  // namespace
}  // namespace servogate::axis
