// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "firmware_if/canopen/402/statusword.hpp"
#include "tests/mock/drive/drive_bench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::mock {
namespace {

using image::DriveState;

// Numbers of the transitions as in the figure of CiA 402-2, "Finite state automaton".
struct DriveStates : testing::Test {
  DriveBench b;
  DriveState state() {
    const auto decoded = canopen::decode_state(b.status());
    EXPECT_TRUE(decoded.has_value());
    EXPECT_EQ(*decoded, b.drive.state());
    return *decoded;
  }
  void to_ready() { b.control(0x06); }
  void to_switched_on() {
    to_ready();
    b.control(0x07);
  }
  void to_enabled() {
    to_switched_on();
    b.control(0x0F);
    ASSERT_EQ(state(), DriveState::operation_enabled);
  }
  /// Operation enabled and turning in profile velocity.
  void to_turning() {
    b.write(0x6060, 0, 3, 1);
    b.write(0x6083, 0, 26'214'400, 4);  // 100 rev/s^2
    b.write(0x6084, 0, 2'621'440, 4);   // 10 rev/s^2
    b.write(0x6085, 0, 26'214'400, 4);
    to_enabled();
    b.write(0x60FF, 0, 2'621'440, 4);  // 10 rev/s
    b.run(200);
    ASSERT_NEAR(b.drive.velocity_counts_s(), 2'621'440, 26'214);
  }
  bool resting() { return std::abs(b.drive.velocity_counts_s()) < 13'107; }
};

TEST_F(DriveStates, transitions_0_and_1_lead_by_themselves_to_switch_on_disabled) {
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
}
TEST_F(DriveStates, transition_2_shutdown) {
  to_ready();
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
}
TEST_F(DriveStates, transition_3_switch_on) {
  to_switched_on();
  EXPECT_EQ(state(), DriveState::switched_on);
}
TEST_F(DriveStates, transition_4_enable_operation) { to_enabled(); }
TEST_F(DriveStates, transitions_3_and_4_follow_one_command_0F) {
  to_ready();
  b.control(0x0F);
  EXPECT_EQ(state(), DriveState::operation_enabled);
}
TEST_F(DriveStates, transition_5_disable_operation) {
  to_enabled();
  b.control(0x07);
  EXPECT_EQ(state(), DriveState::switched_on);
}
TEST_F(DriveStates, transition_6_shutdown_from_switched_on) {
  to_switched_on();
  b.control(0x06);
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
}
TEST_F(DriveStates, transition_7_disable_voltage_or_quick_stop_from_ready) {
  for (const int word : {0x00, 0x02}) {
    to_ready();
    b.control(static_cast<std::uint16_t>(word));
    EXPECT_EQ(state(), DriveState::switch_on_disabled);
  }
}
TEST_F(DriveStates, transition_8_shutdown_from_enabled) {
  to_enabled();
  b.control(0x06);
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
}
TEST_F(DriveStates, transition_9_disable_voltage_from_enabled_lets_the_motor_coast) {
  to_turning();
  b.control(0x00);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
  EXPECT_FALSE(resting());
  EXPECT_NEAR(b.drive.torque_permille(), 0.0, 1.0);
}
TEST_F(DriveStates, transition_10_disable_voltage_or_quick_stop_from_switched_on) {
  for (const int word : {0x00, 0x02}) {
    to_switched_on();
    b.control(static_cast<std::uint16_t>(word));
    EXPECT_EQ(state(), DriveState::switch_on_disabled);
  }
}
TEST_F(DriveStates, transitions_11_and_12_quick_stop_ramps_down_and_switches_off) {
  to_turning();
  b.control(0x02);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
  b.run(300);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
  EXPECT_TRUE(resting());
}
TEST_F(DriveStates, transition_16_is_open_only_with_a_quick_stop_option_of_5_to_8) {
  for (const int option : {5, 6, 7, 8}) {
    to_enabled();
    b.write(0x605A, 0, option, 2);
    b.control(0x02, 50);
    EXPECT_EQ(state(), DriveState::quick_stop_active) << option;
    EXPECT_TRUE(b.status() & 0x0400) << "target reached at rest";
    b.control(0x0F);
    EXPECT_EQ(state(), DriveState::operation_enabled) << option;
    b.control(0x00);
  }
}
TEST_F(DriveStates, a_quick_stop_from_standstill_is_shown_by_a_pdo_of_its_cycle) {
  constexpr std::uint16_t kMask = 0x6F, kQuickStopActive = 0x07;
  for (const int cycle_ms : {1, 4, 20}) {
    b.start_cyclic_position();
    b.write(0x605A, 0, 2, 2);
    const auto cycle = [&](std::uint16_t word) {
      b.cycle(word, 0);
      b.run(cycle_ms - 1);
      std::uint16_t status = 0;
      while (const auto f = b.take(0x185)) status = static_cast<std::uint16_t>(f->data[0] | f->data[1] << 8);
      return status;
    };
    for (const std::uint16_t word : {0x06, 0x07, 0x0F})
      for (int i = 0; i < 100 / cycle_ms + 3; ++i) cycle(word);
    ASSERT_EQ(state(), DriveState::operation_enabled) << cycle_ms;
    int shown = 0;
    for (int i = 0; i < 6; ++i) shown += (cycle(0x02) & kMask) == kQuickStopActive ? 1 : 0;
    EXPECT_GE(shown, 1) << cycle_ms << " ms";
    EXPECT_LE(shown, 2) << "from standstill it need not brake";
    EXPECT_EQ(state(), DriveState::switch_on_disabled);
    b.nmt(0x80);
  }
}
TEST_F(DriveStates, transition_12_disable_voltage_ends_a_quick_stop_that_stays) {
  b.write(0x605A, 0, 6, 2);
  to_turning();
  b.control(0x02);
  EXPECT_EQ(state(), DriveState::quick_stop_active);
  b.control(0x00);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
  EXPECT_FALSE(resting()) << "switched off in the middle of the ramp";
}
TEST_F(DriveStates, transitions_13_14_15_fault_reaction_fault_and_reset_by_the_edge_of_bit_7) {
  to_turning();
  b.drive.inject({.kind = fault::Kind::emcy, .error_code = 0x5112});
  b.run(2);
  EXPECT_EQ(state(), DriveState::fault_reaction_active);
  EXPECT_FALSE(resting());
  b.run(300);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_TRUE(resting());
  EXPECT_EQ(b.read(0x603F), 0x5112u);
  b.control(0x06);
  EXPECT_EQ(state(), DriveState::fault);
  b.control(0x80);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
  EXPECT_EQ(b.read(0x603F), 0u);
}
TEST_F(DriveStates, a_fault_reset_bit_that_is_held_resets_only_once) {
  b.control(0x80);
  b.drive.inject({.kind = fault::Kind::over_current});
  b.run(5);
  EXPECT_EQ(state(), DriveState::fault);
  b.control(0x80);
  EXPECT_EQ(state(), DriveState::fault) << "no edge";
  b.control(0x00);
  b.control(0x80);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
}
TEST_F(DriveStates, a_fault_comes_from_every_state) {
  for (int depth = 0; depth < 4; ++depth) {
    if (depth >= 1) b.control(0x06);
    if (depth >= 2) b.control(0x07);
    if (depth >= 3) b.control(0x0F);
    b.drive.inject({.kind = fault::Kind::encoder_fault});
    b.run(5);
    EXPECT_EQ(state(), DriveState::fault) << depth;
    EXPECT_EQ(b.read(0x603F), 0x7305u);
    b.control(0x00);
    b.control(0x80);
    b.control(0x00);
  }
}

TEST_F(DriveStates, switch_on_needs_the_main_voltage_and_its_loss_in_operation_is_3220) {
  b.drive.set_main_voltage(false);
  to_switched_on();
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
  EXPECT_FALSE(b.status() & 0x10);
  b.drive.set_main_voltage(true);
  b.run(2);
  EXPECT_EQ(state(), DriveState::switched_on);
  b.control(0x0F);
  b.drive.set_main_voltage(false);
  b.run(5);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_EQ(b.read(0x603F), 0x3220u);
}
TEST_F(DriveStates, safe_torque_off_takes_the_torque_at_once) {
  to_turning();
  b.drive.set_safe_torque_off(false);
  b.run(5);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_NEAR(b.drive.torque_permille(), 0.0, 1.0);
}

TEST_F(DriveStates, disable_operation_ramps_down_first_with_605C_1_and_coasts_with_0) {
  to_turning();
  b.control(0x07, 100);
  EXPECT_EQ(state(), DriveState::operation_enabled) << "10 rev/s at 10 rev/s^2 take a second";
  b.run(1100);
  EXPECT_EQ(state(), DriveState::switched_on);
  EXPECT_TRUE(resting());
  b.write(0x605C, 0, 0, 2);
  b.control(0x0F);
  b.run(200);
  b.control(0x07);
  EXPECT_EQ(state(), DriveState::switched_on);
  EXPECT_FALSE(resting());
}
TEST_F(DriveStates, shutdown_coasts_with_605B_0_and_ramps_with_1) {
  to_turning();
  b.control(0x06);
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
  EXPECT_FALSE(resting());
  b.write(0x605B, 0, 1, 2);
  b.control(0x0F, 300);
  b.control(0x06);
  EXPECT_EQ(state(), DriveState::operation_enabled);
  b.run(1200);
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
  EXPECT_TRUE(resting());
}
TEST_F(DriveStates, quick_stop_options_choose_the_ramp) {
  struct Case {
    int option;
    double low_ms, high_ms;
  };
  // 10 rev/s: 1 s on the slow-down ramp, 100 ms on the quick-stop ramp, less with all the torque.
  for (const Case c : {Case{1, 950, 1150}, {2, 90, 180}, {3, 5, 90}, {4, 5, 90}}) {
    b.control(0x00, 3000);
    to_turning();
    b.write(0x605A, 0, c.option, 2);
    b.control(0x02, 0);
    int ms = 0;
    while (b.drive.state() != DriveState::switch_on_disabled && ms < 3000) {
      b.run(1);
      ++ms;
    }
    EXPECT_GE(ms, c.low_ms) << c.option;
    EXPECT_LE(ms, c.high_ms) << c.option;
    EXPECT_TRUE(resting()) << c.option;
  }
}
TEST_F(DriveStates, quick_stop_option_0_switches_the_drive_off) {
  to_turning();
  b.write(0x605A, 0, 0, 2);
  b.control(0x02);
  EXPECT_EQ(state(), DriveState::switch_on_disabled);
  EXPECT_FALSE(resting());
}
TEST_F(DriveStates, fault_reaction_option_0_coasts) {
  to_turning();
  b.write(0x605E, 0, 0, 2);
  b.drive.inject({.kind = fault::Kind::emcy, .error_code = 0x5112});
  b.run(5);
  EXPECT_EQ(state(), DriveState::fault);
  EXPECT_FALSE(resting());
}
TEST_F(DriveStates, halt_stops_the_motion_and_keeps_operation_enabled) {
  to_turning();
  b.control(0x010F, 1200);
  EXPECT_EQ(state(), DriveState::operation_enabled);
  EXPECT_TRUE(resting());
  EXPECT_TRUE(b.status() & 0x0400);
  b.control(0x000F, 1500);
  EXPECT_NEAR(b.drive.velocity_counts_s(), 2'621'440, 26'214);
}

TEST_F(DriveStates, a_stuck_state_machine_refuses_the_transition_until_it_is_let_go) {
  b.drive.inject({.kind = fault::Kind::stuck_state, .state = DriveState::ready_to_switch_on});
  to_switched_on();
  b.control(0x0F, 100);
  EXPECT_EQ(state(), DriveState::ready_to_switch_on);
  b.drive.clear(fault::Kind::stuck_state);
  b.run(5);
  EXPECT_EQ(state(), DriveState::operation_enabled);
}

TEST(DriveBrake, it_opens_before_operation_is_enabled_and_closes_before_the_power_goes) {
  SimulatedDriveConfig config;
  config.plant.brake_torque_nm = 8.0;
  config.plant.load_torque_nm = 1.5;  // a vertical axis
  config.plant.brake_release_s = 0.05;
  config.plant.brake_engage_s = 0.08;
  DriveBench b(config);
  b.control(0x06);
  b.control(0x07, 20);
  EXPECT_FALSE(b.drive.brake_released());
  b.control(0x0F, 10);
  EXPECT_TRUE(b.drive.brake_released());
  EXPECT_EQ(b.drive.state(), DriveState::switched_on) << "still opening";
  b.run(60);
  EXPECT_EQ(b.drive.state(), DriveState::operation_enabled);
  const auto here = b.drive.position_counts();
  b.control(0x07, 40);
  EXPECT_FALSE(b.drive.brake_released());
  EXPECT_EQ(b.drive.state(), DriveState::operation_enabled) << "the motor holds until the brake does";
  b.run(100);
  EXPECT_EQ(b.drive.state(), DriveState::switched_on);
  b.control(0x00, 500);
  EXPECT_LT(std::abs(b.drive.position_counts() - here), 262'144 / 100) << "the axis has not fallen";
}

TEST(DriveStatesAtRandom, every_status_word_decodes_and_only_transitions_of_the_standard_happen) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  using enum DriveState;
  const std::vector<std::pair<DriveState, DriveState>> allowed = {
      {switch_on_disabled, ready_to_switch_on}, {ready_to_switch_on, switched_on},
      {switched_on, operation_enabled},         {operation_enabled, switched_on},
      {switched_on, ready_to_switch_on},        {ready_to_switch_on, switch_on_disabled},
      {operation_enabled, ready_to_switch_on},  {operation_enabled, switch_on_disabled},
      {switched_on, switch_on_disabled},        {operation_enabled, quick_stop_active},
      {quick_stop_active, switch_on_disabled},  {quick_stop_active, operation_enabled},
      {fault_reaction_active, fault},           {fault, switch_on_disabled}};
  SimulatedDriveConfig config;
  config.servo_period_ns = image::kMillisecond;  // one transition at most between two looks
  DriveBench b(config);
  b.nmt(0x01);
  DriveState before = b.drive.state();
  for (int i = 0; i < 20'000; ++i) {
    if (random() % 4 == 0) {
      const std::uint16_t words[] = {0x00, 0x02, 0x06, 0x07, 0x0F, 0x80, 0x0F, 0x10F};
      const std::uint16_t word = random() % 8 ? words[random() % 8] : static_cast<std::uint16_t>(random());
      b.send(0x205, {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8)});
    }
    if (random() % 200 == 0) b.drive.inject({.kind = fault::Kind::over_temperature});
    b.run(1);
    b.seen.clear();
    const DriveState now = b.drive.state();
    ASSERT_TRUE(canopen::decode_state(b.drive.statusword()));
    if (now != before) {
      const bool known = now == fault_reaction_active ||
                         std::find(allowed.begin(), allowed.end(), std::pair{before, now}) != allowed.end();
      ASSERT_TRUE(known) << static_cast<int>(before) << " -> " << static_cast<int>(now);
    }
    before = now;
  }
}

}  // namespace
}  // namespace servogate::mock
