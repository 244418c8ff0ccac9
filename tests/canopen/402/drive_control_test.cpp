// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/drive_control.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/canopen/drive_model.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using testing::DriveModel;
constexpr image::Nanoseconds kMs = image::kMillisecond;

struct DriveControlTest : ::testing::Test {
  std::uint16_t step() {
    control.on_statusword(encode_state(drive.state));
    const std::uint16_t word = control.step(now, wish);
    drive.step(word);
    now += kMs;
    return word;
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) step();
  }
  DriveControl control{{FaultReset::edge, 20 * kMs, 500 * kMs}};
  DriveControl::Wish wish;
  DriveModel drive;
  image::Nanoseconds now = 0;
};

TEST_F(DriveControlTest, goes_up_by_shutdown_switch_on_enable_operation) {
  wish.power = PowerWish::on;
  EXPECT_EQ(step(), controlword::kCommandShutdown);
  EXPECT_EQ(step(), controlword::kCommandSwitchOn);
  EXPECT_EQ(step(), controlword::kCommandEnableOperation);
  EXPECT_EQ(drive.state, DriveState::operation_enabled);
  EXPECT_EQ(step(), controlword::kCommandEnableOperation);
}

TEST_F(DriveControlTest, goes_down_by_shutdown_and_disable_voltage) {
  wish.power = PowerWish::on;
  run(5);
  wish.power = PowerWish::off;
  EXPECT_EQ(step(), controlword::kCommandShutdown);
  EXPECT_EQ(step(), controlword::kCommandDisableVoltage);
  EXPECT_EQ(drive.state, DriveState::switch_on_disabled);
  run(2000);
  EXPECT_EQ(control.refusal().waited_ms, 0) << "resting is no refusal";
}

TEST_F(DriveControlTest, waits_in_switched_on_for_the_mode) {
  wish.power = PowerWish::on;
  wish.mode_ready = false;
  run(10);
  EXPECT_EQ(drive.state, DriveState::switched_on);
  wish.mode_ready = true;
  run(2);
  EXPECT_EQ(drive.state, DriveState::operation_enabled);
}

TEST_F(DriveControlTest, holds_quick_stop_until_the_wish_ends_and_comes_back_by_the_long_way) {
  wish.power = PowerWish::on;
  run(5);
  wish.power = PowerWish::quick_stop;
  EXPECT_EQ(step(), controlword::kCommandQuickStop);
  EXPECT_EQ(step(), controlword::kCommandQuickStop);
  EXPECT_EQ(drive.state, DriveState::quick_stop_active);
  wish.power = PowerWish::on;
  EXPECT_EQ(step(), controlword::kCommandDisableVoltage);
  run(5);
  EXPECT_EQ(drive.state, DriveState::operation_enabled);
}

TEST_F(DriveControlTest, leaves_a_fault_only_by_one_pulse_per_wish) {
  drive.state = DriveState::fault;
  wish.power = PowerWish::on;
  run(100);
  EXPECT_EQ(drive.state, DriveState::fault) << "power alone does not reset";
  wish.reset_fault = true;
  EXPECT_EQ(step(), controlword::kCommandFaultReset);
  EXPECT_EQ(drive.state, DriveState::switch_on_disabled);
  run(5);
  EXPECT_EQ(drive.state, DriveState::operation_enabled);
  drive.state = DriveState::fault;
  run(100);
  EXPECT_EQ(drive.state, DriveState::fault) << "a wish that stood before the fault counts for nothing";
  wish.reset_fault = false;
  step();
  wish.reset_fault = true;
  step();
  EXPECT_EQ(drive.state, DriveState::switch_on_disabled);
}

TEST_F(DriveControlTest, keeps_the_reset_bit_for_the_hold_time_and_then_takes_it_away) {
  drive.state = DriveState::fault;
  drive.refuses = DriveState::switch_on_disabled;
  step();
  wish.reset_fault = true;
  int high = 0;
  for (int i = 0; i < 100; ++i) high += step() == controlword::kCommandFaultReset;
  EXPECT_EQ(high, 20);
}

TEST_F(DriveControlTest, a_level_drive_gets_the_bit_as_long_as_the_wish_stands) {
  control = DriveControl({FaultReset::level, 20 * kMs, 500 * kMs});
  drive.state = DriveState::fault;
  drive.refuses = DriveState::switch_on_disabled;
  step();
  wish.reset_fault = true;
  int high = 0;
  for (int i = 0; i < 100; ++i) high += step() == controlword::kCommandFaultReset;
  EXPECT_EQ(high, 100);
  wish.reset_fault = false;
  EXPECT_EQ(step(), controlword::kCommandDisableVoltage);
}

TEST_F(DriveControlTest, a_wish_during_the_fault_reaction_is_served_in_fault) {
  wish.power = PowerWish::on;
  run(5);
  drive.state = DriveState::fault_reaction_active;
  control.on_statusword(encode_state(drive.state));
  control.step(now, wish);
  wish.reset_fault = true;
  control.step(now, wish);
  drive.state = DriveState::fault;
  step();
  EXPECT_EQ(drive.state, DriveState::switch_on_disabled);
}

TEST_F(DriveControlTest, names_the_transition_a_drive_does_not_follow) {
  wish.power = PowerWish::on;
  drive.refuses = DriveState::operation_enabled;
  run(2 + 500);
  EXPECT_EQ(control.refusal().waited_ms, 0);
  run(2);
  EXPECT_EQ(control.refusal().from, DriveState::switched_on);
  EXPECT_EQ(control.refusal().wanted, DriveState::operation_enabled);
  EXPECT_GE(control.refusal().waited_ms, 500);
  drive.refuses = DriveState::offline;
  run(2);
  EXPECT_EQ(control.refusal().waited_ms, 0);
}

TEST_F(DriveControlTest, names_a_refused_fault_reset) {
  drive.state = DriveState::fault;
  drive.refuses = DriveState::switch_on_disabled;
  run(1000);
  EXPECT_EQ(control.refusal().waited_ms, 0) << "nobody has asked yet";
  wish.reset_fault = true;
  run(510);
  EXPECT_EQ(control.refusal().from, DriveState::fault);
  EXPECT_EQ(control.refusal().wanted, DriveState::switch_on_disabled);
}

TEST_F(DriveControlTest, an_undefined_statusword_changes_nothing) {
  wish.power = PowerWish::on;
  run(5);
  control.on_statusword(0x0001);
  EXPECT_EQ(control.state(), DriveState::operation_enabled);
  EXPECT_EQ(control.step(now, wish), controlword::kCommandEnableOperation);
}

TEST_F(DriveControlTest, says_nothing_dangerous_before_the_first_statusword) {
  wish.power = PowerWish::on;
  EXPECT_EQ(control.step(now, wish), controlword::kCommandDisableVoltage);
}

TEST(DriveControlProperty, reaches_every_wish_from_every_state_over_a_lossy_wire) {
  constexpr unsigned kSeed = 402;
  std::mt19937 random(kSeed);
  constexpr DriveState kStart[] = {DriveState::switch_on_disabled,   DriveState::ready_to_switch_on,
                                   DriveState::switched_on,          DriveState::operation_enabled,
                                   DriveState::quick_stop_active,    DriveState::fault,
                                   DriveState::fault_reaction_active};
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    DriveControl control({FaultReset::edge, 20 * kMs, 500 * kMs});
    DriveModel drive;
    drive.state = kStart[random() % std::size(kStart)];
    DriveControl::Wish wish;
    std::uint16_t on_the_wire = 0;
    bool on = false;
    for (int cycle = 0; cycle < 600; ++cycle) {
      if (cycle % 200 == 0) on = random() % 2;
      wish.power = on ? PowerWish::on : PowerWish::off;
      wish.reset_fault = cycle % 50 < 25;
      if (random() % 5) control.on_statusword(encode_state(drive.state));
      const std::uint16_t word = control.step(cycle * kMs, wish);
      if (random() % 5) drive.step(on_the_wire);
      on_the_wire = word;
      if (cycle % 200 == 199) {
        ASSERT_EQ(drive.state, on ? DriveState::operation_enabled : DriveState::switch_on_disabled);
      }
    }
  }
}

}  // namespace
}  // namespace servogate::canopen
