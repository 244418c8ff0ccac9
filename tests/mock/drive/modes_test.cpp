// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

constexpr std::int64_t kTurn = 262'144;

struct DriveModes : testing::Test {
  DriveBench b;
  void mode(int m) { ASSERT_EQ(b.write(0x6060, 0, m, 1), 0u); }
  std::int32_t position() { return b.read_signed(0x6064); }
};

TEST_F(DriveModes, every_number_that_is_no_supported_mode_is_refused_and_changes_nothing) {
  constexpr int kSupported[] = {0, 1, 2, 3, 4, 6, 7, 8, 9, 10};
  mode(3);
  b.enable();
  for (int m = -128; m < 128; ++m) {
    const bool known = std::find(std::begin(kSupported), std::end(kSupported), m) != std::end(kSupported);
    EXPECT_EQ(b.write(0x6060, 0, m, 1), known ? 0u : 0x06090030u) << m;
    b.run(2);
    EXPECT_EQ(static_cast<std::int8_t>(b.read(0x6061)), known ? m : 3) << m;
    if (known) mode(3), b.run(2);
  }
}

TEST_F(DriveModes, supported_modes_and_their_display_agree) {
  EXPECT_EQ(b.read(0x6502), 0x000003EFu);  // pp, vl, pv, tq, hm, ip, csp, csv, cst
  for (const int m : {1, 2, 3, 4, 6, 7, 8, 9, 10}) {
    mode(m);
    b.run(2);
    EXPECT_EQ(b.read(0x6061), static_cast<std::uint32_t>(m));
  }
  for (const int m : {5, 11, -1}) EXPECT_NE(b.write(0x6060, 0, m, 1), 0u) << m;
}

// ---- cyclic synchronous position ----

struct DriveCsp : DriveModes {
  void SetUp() override {
    b.start_cyclic_position();
    for (const int word : {0x06, 0x07, 0x0F})
      for (int i = 0; i < 5; ++i) b.cycle(static_cast<std::uint16_t>(word), 0);
    ASSERT_EQ(b.drive.state(), image::DriveState::operation_enabled);
  }
};

TEST_F(DriveCsp, the_shaft_follows_a_constant_speed_with_an_error_of_a_few_counts) {
  // 10 rev/s: 2621 counts a cycle. The target sent in cycle k acts at SYNC k+1 and is reached at SYNC k+2.
  double ramp = 0.0, at = 0.0;
  std::vector<std::int32_t> targets;
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    ramp = std::min(2621.0, ramp + 26.0);
    at += ramp;
    targets.push_back(static_cast<std::int32_t>(at));
    b.cycle(0x0F, targets.back());
    const std::int32_t actual = b.tpdo_position();
    if (k > 500)
      worst =
          std::max(worst, std::abs(static_cast<double>(targets[static_cast<std::size_t>(k - 2)] - actual)));
  }
  EXPECT_LT(worst, 40.0);
  EXPECT_NEAR(b.read_signed(0x606C), 2'621'000, 30'000);
  EXPECT_TRUE(b.status() & 0x1000) << "drive follows the command value";
}

TEST_F(DriveCsp, a_target_given_before_enabling_is_not_jumped_to) {
  for (int i = 0; i < 5; ++i) b.cycle(0x07, 1'000'000);
  b.cycle(0x0F, 1'000'000);
  b.run(20);  // no further target
  EXPECT_LT(std::abs(b.drive.position_counts()), kTurn / 2);
}

TEST_F(DriveCsp, the_counter_wraps_at_32_bits_and_the_motion_goes_on) {
  // Half the range of 32 bits is 8192 revolutions: wrap by starting near the end.
  SimulatedDriveConfig config;
  config.absolute_encoder = true;
  config.plant.start_rev = 8191.9;
  DriveBench w(config);
  w.start_cyclic_position();
  auto target = static_cast<std::uint32_t>(w.drive.reported_position());
  for (const int word : {0x06, 0x07, 0x0F})
    for (int i = 0; i < 5; ++i) w.cycle(static_cast<std::uint16_t>(word), static_cast<std::int32_t>(target));
  const auto from = w.drive.reported_position();
  for (int i = 0; i < 200; ++i) {
    target += 262;
    w.cycle(0x0F, static_cast<std::int32_t>(target));
  }
  for (int i = 0; i < 200; ++i) w.cycle(0x0F, static_cast<std::int32_t>(target));
  EXPECT_NEAR(static_cast<double>(w.drive.reported_position() - from), 200 * 262, 20);
  EXPECT_LT(w.tpdo_position(), 0);
  EXPECT_EQ(w.drive.state(), image::DriveState::operation_enabled);
}

TEST_F(DriveCsp, bit_13_comes_after_the_time_of_6066_and_stays_until_the_fault_is_reset) {
  b.write(0x6065, 0, 1000, 4);
  b.write(0x6066, 0, 100, 2);
  b.write(0x6072, 0, 0, 2);  // no torque: the shaft stays where it is
  int outside = 0, before = 0;
  for (int i = 1; i < 300 && b.drive.state() == image::DriveState::operation_enabled; ++i) {
    b.cycle(0x0F, 100 * i);
    const bool beyond = std::abs(b.drive.object(0x60F4)) > 1000;
    outside += beyond;
    before +=
        beyond && b.drive.state() == image::DriveState::operation_enabled && (b.drive.statusword() & 0x2000);
  }
  EXPECT_NEAR(outside, 100, 3) << "ms";
  EXPECT_EQ(before, 0) << "the time is not over";
  b.run(200);
  EXPECT_EQ(b.drive.state(), image::DriveState::fault);
  EXPECT_TRUE(b.drive.statusword() & 0x2000);
  b.cycle(0x00, 0);
  b.cycle(0x80, 0);
  b.cycle(0x80, 0);
  EXPECT_EQ(b.drive.state(), image::DriveState::switch_on_disabled);
  EXPECT_FALSE(b.drive.statusword() & 0x2000);
}

TEST_F(DriveCsp, a_following_error_beyond_its_window_and_time_is_fault_8611) {
  b.write(0x6065, 0, 1000, 4);
  b.write(0x6066, 0, 20, 2);
  b.write(0x6072, 0, 10, 2);  // one per cent of torque cannot follow
  b.seen.clear();
  for (int i = 1; i < 60; ++i) b.cycle(0x0F, 2000 * i);
  EXPECT_EQ(b.drive.error_code(), 0x8611);
  const auto emcy = b.take(0x085);
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x8611);
}

TEST_F(DriveCsp, a_window_of_all_ones_switches_the_supervision_off) {
  b.write(0x6065, 0, 0xFFFFFFFF, 4);
  b.write(0x6072, 0, 10, 2);
  for (int i = 1; i < 100; ++i) b.cycle(0x0F, 2000 * i);
  EXPECT_EQ(b.drive.state(), image::DriveState::operation_enabled);
}

TEST_F(DriveCsp, software_limits_hold_the_axis_and_raise_the_internal_limit_bit) {
  b.write(0x607D, 2, 20'000, 4);
  for (int i = 1; i < 100; ++i) b.cycle(0x0F, 400 * i);
  b.run(50);
  EXPECT_NEAR(position(), 20'000, 20);
  EXPECT_TRUE(b.status() & 0x0800);
}

TEST_F(DriveCsp, a_limit_switch_of_the_drive_stops_motion_towards_it_and_lets_it_go_away) {
  b.drive.set_input(DriveSwitch::Input::positive_limit, true);
  for (int i = 1; i < 50; ++i) b.cycle(0x0F, 400 * i);
  EXPECT_LT(position(), 400);
  EXPECT_TRUE(b.read(0x60FD) & 0x2);
  for (int i = 1; i < 50; ++i) b.cycle(0x0F, -400 * i);
  EXPECT_LT(position(), -18'000);
}

TEST_F(DriveCsp, a_missing_pdo_makes_the_axis_wait_and_not_run_on) {
  for (int i = 1; i < 100; ++i) b.cycle(0x0F, 1000 * i);
  for (int i = 0; i < 50; ++i) {
    b.send(0x080, {});
    b.run(1);
  }
  EXPECT_NEAR(position(), 99'000, 50);
}

// ---- cyclic synchronous velocity and torque ----

TEST_F(DriveModes, csv_holds_the_target_velocity_plus_offset) {
  mode(9);
  b.enable();
  b.write(0x60FF, 0, 1'000'000, 4);
  b.write(0x60B1, 0, 50'000, 4);
  b.run(300);
  EXPECT_NEAR(b.read_signed(0x606C), 1'050'000, 10'000);
}

TEST_F(DriveModes, cst_accelerates_as_torque_and_inertia_say) {
  mode(10);
  b.write(0x60FF, 0, 0, 4);
  b.enable();
  b.write(0x6071, 0, 500, 2);  // 1.2 N m against 0.1 N m of friction on 1e-3 kg m^2: 1100 rad/s^2
  const double v0 = b.drive.velocity_counts_s();
  b.run(100);
  const double gained = (b.drive.velocity_counts_s() - v0) / kTurn * 2 * M_PI;
  EXPECT_NEAR(gained, 110.0, 6.0);
  EXPECT_NEAR(static_cast<std::int16_t>(b.read(0x6077)), 500, 5);
}

TEST_F(DriveModes, profile_torque_rises_with_its_slope) {
  mode(4);
  b.write(0x6087, 0, 1000, 4);  // permille a second
  b.enable();
  b.write(0x6071, 0, 300, 2);
  b.run(100);
  EXPECT_NEAR(static_cast<std::int16_t>(b.read(0x6077)), 105, 12);
  b.run(300);
  EXPECT_NEAR(static_cast<std::int16_t>(b.read(0x6077)), 300, 5);
}

// ---- profile velocity ----

TEST_F(DriveModes, pv_ramps_with_6083_reports_target_reached_and_zero_speed) {
  mode(3);
  b.write(0x6083, 0, 2'621'440, 4);  // 10 rev/s^2
  b.enable();
  EXPECT_TRUE(b.status() & 0x1000) << "speed is zero";
  b.write(0x60FF, 0, 1'310'720, 4);  // 5 rev/s after half a second
  b.run(250);
  EXPECT_NEAR(b.drive.velocity_counts_s(), 655'360, 30'000);
  EXPECT_FALSE(b.status() & 0x0400);
  b.run(400);
  EXPECT_TRUE(b.status() & 0x0400);
  EXPECT_FALSE(b.status() & 0x1000);
}

TEST_F(DriveModes, pv_does_not_exceed_the_maximum_profile_velocity) {
  mode(3);
  b.write(0x607F, 0, 500'000, 4);
  b.enable();
  b.write(0x60FF, 0, -5'000'000, 4);
  b.run(500);
  EXPECT_NEAR(b.drive.velocity_counts_s(), -500'000, 10'000);
  EXPECT_TRUE(b.status() & 0x0800);
}

// ---- profile position ----

struct DrivePp : DriveModes {
  void SetUp() override {
    mode(1);
    b.write(0x6081, 0, 2'621'440, 4);   // 10 rev/s
    b.write(0x6083, 0, 26'214'400, 4);  // 100 rev/s^2
    b.write(0x6084, 0, 26'214'400, 4);
    b.enable();
  }
  void target(std::int64_t x) { b.write(0x607A, 0, x, 4); }
};

TEST_F(DrivePp, a_set_point_is_taken_acknowledged_reached_and_released) {
  target(kTurn);
  b.control(0x1F);
  EXPECT_EQ(b.status() & 0x1400, 0x1000) << "acknowledged, not reached";
  b.control(0x0F);
  EXPECT_FALSE(b.status() & 0x1000);
  b.run(400);
  EXPECT_TRUE(b.status() & 0x0400);
  EXPECT_NEAR(position(), kTurn, 10);
}

TEST_F(DrivePp, the_move_takes_the_time_of_a_trapezoid) {
  // 1 rev at 10 rev/s and 100 rev/s^2: 0.1 s up, none at speed, 0.1 s down.
  target(kTurn);
  b.control(0x1F, 0);
  int ms = 0;
  while (!(b.drive.statusword() & 0x0400) && ms < 1000) {
    b.run(1);
    ++ms;
  }
  EXPECT_NEAR(ms, 205, 20);
}

TEST_F(DrivePp, relative_moves_add_up_and_a_second_one_waits_for_the_first) {
  target(kTurn);
  b.control(0x5F);
  b.control(0x4F);
  target(kTurn / 2);
  b.control(0x5F);
  EXPECT_TRUE(b.status() & 0x1000);
  b.control(0x4F);
  EXPECT_TRUE(b.status() & 0x1000) << "the buffer is full until the first one is done";
  b.run(800);
  EXPECT_FALSE(b.status() & 0x1000);
  EXPECT_NEAR(position(), kTurn + kTurn / 2, 10);
}

TEST_F(DrivePp, change_immediately_replaces_the_motion_under_way) {
  target(20 * kTurn);
  b.control(0x1F, 300);
  b.control(0x0F);
  target(-kTurn);
  b.control(0x3F);
  b.run(2000);
  EXPECT_NEAR(position(), -kTurn, 10);
}

TEST_F(DrivePp, halt_interrupts_and_its_end_resumes) {
  target(10 * kTurn);
  b.control(0x1F, 300);
  b.control(0x11F, 300);
  const auto held = position();
  EXPECT_LT(held, 9 * kTurn);
  b.run(200);
  EXPECT_NEAR(position(), held, 20);
  b.control(0x1F, 1500);
  EXPECT_NEAR(position(), 10 * kTurn, 10);
}

TEST_F(DrivePp, a_target_beyond_the_software_limit_ends_at_the_limit) {
  b.write(0x607D, 1, -1000, 4);
  target(-kTurn);
  b.control(0x1F, 500);
  EXPECT_NEAR(position(), -1000, 10);
  EXPECT_TRUE(b.status() & 0x0800);
}

// ---- touch probe ----

struct DriveProbe : DriveModes {
  void turn(std::int32_t speed, int ms) {
    b.write(0x60FF, 0, speed, 4);
    b.run(ms);
  }
  void SetUp() override {
    mode(9);
    b.enable();
  }
};

TEST_F(DriveProbe, the_zero_mark_is_latched_to_the_count) {
  // The shaft started on the mark at 0; the next one is a turn away.
  b.write(0x60B8, 0, 0x0015, 2);  // enable, zero mark, positive edge, first event
  b.run(2);
  EXPECT_EQ(b.read(0x60B9), 0x0001u);
  turn(1'000'000, 400);
  EXPECT_EQ(b.read(0x60B9), 0x0003u);
  EXPECT_EQ(b.read_signed(0x60BA), kTurn);
  EXPECT_EQ(b.read(0x60D5), 1u) << "single event";
}

TEST_F(DriveProbe, arming_again_needs_the_enable_bit_to_fall) {
  b.write(0x60B8, 0, 0x0015, 2);
  turn(1'000'000, 800);
  EXPECT_EQ(b.read_signed(0x60BA), kTurn);
  b.write(0x60B8, 0, 0, 2);
  b.run(2);
  EXPECT_EQ(b.read(0x60B9), 0u);
  const auto turns = b.drive.position_counts() / kTurn;
  b.write(0x60B8, 0, 0x0015, 2);
  b.run(600);
  EXPECT_EQ(b.read_signed(0x60BA), (turns + 1) * kTurn);
}

TEST_F(DriveProbe, continuous_mode_counts_every_mark) {
  b.write(0x60B8, 0, 0x0017, 2);
  turn(2'621'440, 1000);  // about ten turns
  EXPECT_NEAR(b.read(0x60D5), 10, 1);
  EXPECT_EQ(b.read_signed(0x60BA), b.drive.position_counts() / kTurn * kTurn);
}

TEST(DriveProbeInputs, both_edges_of_both_probes_are_latched_where_the_switch_lies) {
  SimulatedDriveConfig config;
  config.switches = {{DriveSwitch::Input::probe_1, 100'123, 150'456},
                     {DriveSwitch::Input::probe_2, 200'001, 250'002}};
  DriveBench b(config);
  b.write(0x6060, 0, 9, 1);
  b.enable();
  b.write(0x60B8, 0, 0x3131, 2);
  b.write(0x60FF, 0, 1'000'000, 4);
  b.run(400);
  EXPECT_EQ(b.read(0x60B9), 0x0707u);
  EXPECT_EQ(b.read_signed(0x60BA), 100'123);
  EXPECT_EQ(b.read_signed(0x60BB), 150'456);
  EXPECT_EQ(b.read_signed(0x60BC), 200'001);
  EXPECT_EQ(b.read_signed(0x60BD), 250'002);
}

TEST(DriveProbeInputs, an_edge_before_arming_is_not_latched) {
  DriveBench b;
  b.drive.set_input(DriveSwitch::Input::probe_1, true);
  b.run(2);
  b.write(0x60B8, 0, 0x0011, 2);
  b.run(5);
  EXPECT_EQ(b.read(0x60B9), 0x0001u);
  b.drive.set_input(DriveSwitch::Input::probe_1, false);
  b.run(2);
  b.drive.set_input(DriveSwitch::Input::probe_1, true);
  b.run(2);
  EXPECT_EQ(b.read(0x60B9), 0x0003u);
}

// ---- velocity (vl) ----

struct DriveVl : DriveModes {
  void SetUp() override {
    mode(2);
    b.write(0x6048, 1, 600, 4);  // 600 rpm in 1 s
    b.write(0x6048, 2, 1, 2);
    b.write(0x6049, 1, 600, 4);
    b.write(0x6049, 2, 1, 2);
    b.enable();
  }
  void target(int rpm) { b.write(0x6042, 0, rpm, 2); }
  double rpm() const { return b.drive.velocity_counts_s() * 60.0 / kTurn; }
};

TEST_F(DriveVl, the_ramp_leads_to_the_target_in_rpm_and_demand_and_actual_are_told) {
  target(300);
  b.control(0x7F, 0);
  b.run(250);
  EXPECT_NEAR(rpm(), 150, 10) << "half of the way after half of the time";
  b.run(500);
  EXPECT_NEAR(rpm(), 300, 3);
  EXPECT_EQ(b.read(0x6043), 300u);
  EXPECT_NEAR(static_cast<double>(b.read(0x6044)), 300, 3);
}

TEST_F(DriveVl, the_bits_of_the_ramp_hold_zero_and_stop_it) {
  target(300);
  b.control(0x7F, 700);
  b.control(0x3F, 250);  // bit 6: reference zero
  EXPECT_NEAR(rpm(), 150, 15);
  b.control(0x1F, 200);  // bit 5: held where it is
  const double held = rpm();
  EXPECT_NEAR(held, 145, 15);
  b.run(200);
  EXPECT_NEAR(rpm(), held, 2);
  b.control(0x0F, 300);  // bit 4: no ramp
  EXPECT_NEAR(rpm(), 0, 1);
}

TEST_F(DriveVl, amounts_beyond_6046_are_cut_with_the_internal_limit_bit) {
  b.write(0x6046, 1, 50, 4);
  b.write(0x6046, 2, 200, 4);
  target(-900);
  b.control(0x7F, 800);
  EXPECT_NEAR(rpm(), -200, 3);
  EXPECT_TRUE(b.status() & 0x0800);
  target(10);
  b.run(1000);
  EXPECT_NEAR(rpm(), 50, 2);
  target(100);
  b.run(500);
  EXPECT_FALSE(b.status() & 0x0800);
}

TEST_F(DriveVl, factors_scale_the_unit_and_may_not_be_zero) {
  EXPECT_EQ(b.write(0x604C, 2, 0, 4), 0x06090030u);
  EXPECT_EQ(b.write(0x604C, 2, 10, 4), 0u);  // tenths of a turn a minute
  b.write(0x6046, 2, 50'000, 4);
  b.write(0x6048, 1, 60'000, 4);
  target(3000);
  b.control(0x7F, 400);
  EXPECT_NEAR(rpm(), 300, 3);
  EXPECT_EQ(b.read(0x6043), 3000u);
}

TEST_F(DriveVl, quick_stop_and_a_ramp_that_is_taken_away_brake_on_604A) {
  b.write(0x604A, 1, 1200, 4);  // 1200 rpm in 1 s
  b.write(0x604A, 2, 1, 2);
  EXPECT_EQ(b.write(0x604A, 1, 0, 4), 0x06090032u) << "no ramp at all";
  for (const std::uint16_t stop : {0x0F, 0x7B}) {  // bit 4 away; quick stop
    b.enable();
    target(600);
    b.control(0x7F, 1300);
    ASSERT_NEAR(rpm(), 600, 3);
    b.control(stop, 250);
    EXPECT_NEAR(rpm(), 300, 20) << std::hex << stop;
    b.run(350);
    EXPECT_NEAR(rpm(), 0, 1) << std::hex << stop;
  }
}

TEST_F(DriveVl, halt_ramps_to_rest) {
  target(300);
  b.control(0x7F, 700);
  b.control(0x17F, 700);
  EXPECT_NEAR(rpm(), 0, 1);
  EXPECT_TRUE(b.status() & 0x0400);
}

// ---- interpolated position (ip) ----

struct DriveIp : DriveModes {
  void SetUp() override {
    mode(7);
    b.write(0x60C2, 1, 10, 1);  // 10 ms a record
    b.write(0x60C4, 2, 8, 4);
    b.enable();
  }
  std::uint32_t record(std::int64_t x) { return b.write(0x60C1, 1, x, 4); }
};

TEST_F(DriveIp, records_wait_in_the_buffer_until_bit_4_starts_them_one_a_period) {
  for (int i = 1; i <= 8; ++i) EXPECT_EQ(record(i * 1000), 0u);
  EXPECT_EQ(b.read(0x60C4, 4), 8u);
  EXPECT_EQ(record(9000), 0x08000022u) << "a full buffer takes no more";
  b.run(50);
  EXPECT_NEAR(position(), 0, 5);
  EXPECT_FALSE(b.status() & 0x1000);
  b.control(0x1F, 0);
  EXPECT_TRUE(b.drive.statusword() & 0x1000);
  b.run(40);
  EXPECT_NEAR(static_cast<double>(b.drive.reported_position()), 4000, 600);
  b.run(80);
  EXPECT_NEAR(position(), 8000, 20) << "the last record is held";
  EXPECT_EQ(b.read(0x60C4, 4), 0u);
}

TEST_F(DriveIp, clearing_closes_the_buffer_until_it_is_opened) {
  record(1000);
  EXPECT_EQ(b.write(0x60C4, 6, 0, 1), 0u);
  EXPECT_EQ(b.read(0x60C4, 4), 0u);
  EXPECT_EQ(record(1000), 0x08000022u);
  EXPECT_EQ(b.write(0x60C4, 6, 1, 1), 0u);
  EXPECT_EQ(record(1000), 0u);
}

TEST_F(DriveIp, a_ring_gives_up_its_oldest_record_and_a_buffer_of_one_holds_the_newest) {
  b.write(0x60C4, 3, 1, 1);
  b.write(0x60C4, 2, 2, 4);
  for (int i = 1; i <= 5; ++i) EXPECT_EQ(record(i * 1000), 0u);
  EXPECT_EQ(b.read(0x60C4, 4), 2u);
  b.control(0x1F, 15);
  EXPECT_NEAR(position(), 4500, 1000) << "from record 4 on";
  b.run(50);
  EXPECT_NEAR(position(), 5000, 20);
  b.control(0x0F);
  b.write(0x60C4, 2, 1, 4);
  record(6000);
  record(7000);
  b.control(0x1F, 60);
  EXPECT_NEAR(position(), 7000, 20);
}

TEST_F(DriveIp, a_record_of_pdo_comes_every_sync_and_the_axis_follows) {
  b.write(0x60C2, 1, 1, 1);
  b.write(0x60C4, 2, 1, 4);
  b.write(0x1400, 1, 0x80000205, 4);
  b.write(0x1600, 0, 0, 1);
  b.write(0x1600, 1, 0x60400010, 4);
  b.write(0x1600, 2, 0x60C10120, 4);
  b.write(0x1600, 0, 2, 1);
  b.write(0x1400, 2, 1, 1);
  b.write(0x1400, 1, 0x205, 4);
  b.nmt(0x01);
  for (int i = 1; i <= 200; ++i) b.cycle(0x1F, i * 100);
  b.cycle(0x1F, 20'000);
  b.run(30);
  EXPECT_NEAR(position(), 20'000, 30);
}

}  // namespace
}  // namespace servogate::mock
