// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/segment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/canopen/master/segment_fixture.hpp"

namespace servogate::canopen {
namespace {

using image::DriveMode;
using image::DriveState;
using testing::SegmentRig;
using testing::show;

TEST(Segment, sends_sync_as_the_first_frame_of_every_cycle) {
  SegmentRig rig(3);
  rig.start();
  for (int i = 0; i < 500; ++i) {
    rig.step();
    ASSERT_FALSE(rig.network.last_sent.empty());
    ASSERT_EQ(show(rig.network.last_sent.front()), "080");
    for (std::size_t n = 1; n < rig.network.last_sent.size(); ++n)
      ASSERT_NE(rig.network.last_sent[n].id, 0x80u);
  }
}

TEST(Segment, boots_all_nodes_while_the_cycle_runs) {
  SegmentRig rig(3);
  rig.start();
  EXPECT_EQ(rig.drive().state, DriveState::offline);
  ASSERT_TRUE(rig.boot());
  EXPECT_EQ(rig.count(BusEventKind::node_booted), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(rig.drive(i).online);
    EXPECT_EQ(rig.drive(i).state, DriveState::switch_on_disabled);
    EXPECT_EQ(rig.drive(i).statusword, 0x0250);
    EXPECT_EQ(rig.device(i).get(0x1A00, 2), 0x60640020u);
  }
  const NodeStatus status = rig.segment->node_status(1);
  EXPECT_EQ(status.node, 2);
  EXPECT_TRUE(status.online);
  EXPECT_EQ(status.boot.step, BootStep::done);
  EXPECT_EQ(status.serial, 1002u);
  EXPECT_EQ(rig.sentence(BusEventKind::node_booted), "X: configured and operational");
}

TEST(Segment, keeps_the_acyclic_frames_of_a_cycle_within_the_bound) {
  SegmentRig rig(8);
  rig.config.sdo_frames_per_cycle = 2;
  rig.start();
  for (int i = 0; i < 1000; ++i) {
    rig.step();
    int acyclic = 0;
    for (const auto& f : rig.network.last_sent) acyclic += f.id == 0 || (f.id & 0x780) == 0x600;
    ASSERT_LE(acyclic, 2);
  }
  EXPECT_TRUE(rig.boot());
}

TEST(Segment, presets_the_target_to_the_actual_position_before_enabling) {
  SegmentRig rig;
  rig.start();
  rig.device().position = 123'456;
  ASSERT_TRUE(rig.boot());
  EXPECT_EQ(rig.drive().position_counts, 123'456);
  ASSERT_TRUE(rig.enable());
  rig.run(20);
  for (const std::int64_t target : rig.device().applied) EXPECT_EQ(target, 123'456);
}

TEST(Segment, holds_a_drive_whose_command_is_elsewhere_and_says_so) {
  SegmentRig rig;
  rig.start();
  rig.device().position = 1'000'000;
  ASSERT_TRUE(rig.boot());
  rig.control = [](image::ProcessImage& image) { image.axes[0].drive_command.power = true; };
  rig.run(100);
  EXPECT_EQ(rig.drive().state, DriveState::operation_enabled);
  for (const std::int64_t target : rig.device().applied) EXPECT_EQ(target, 1'000'000);
  EXPECT_EQ(rig.count(BusEventKind::handover_held), 1);
  EXPECT_EQ(rig.last(BusEventKind::handover_held)->got, -1'000'000);
  rig.control = [](image::ProcessImage& image) { image.axes[0].drive_command.position_counts = 1'000'100; };
  rig.run(3);
  EXPECT_EQ(rig.device().applied.back(), 1'000'100);
}

TEST(Segment, a_target_of_cycle_k_acts_at_sync_k_plus_1_and_its_actual_is_read_in_cycle_k_plus_2) {
  SegmentRig rig;
  rig.start();
  ASSERT_TRUE(rig.boot() && rig.enable());
  rig.run(5);
  const auto start = rig.drive().position_counts;
  std::vector<std::int64_t> sent, read;
  rig.control = [&](image::ProcessImage& image) {
    auto& axis = image.axes[0];
    read.push_back(axis.drive.position_counts);
    axis.drive_command.position_counts = start + 10 * static_cast<std::int64_t>(sent.size() + 1);
    sent.push_back(axis.drive_command.position_counts);
  };
  rig.run(50);
  for (std::size_t k = 0; k + 2 < sent.size(); ++k) ASSERT_EQ(read[k + 2], sent[k]) << k;
}

TEST(Segment, the_position_counts_on_where_the_drive_wraps) {
  SegmentRig rig;
  rig.start();
  rig.device().position = 0x7FFF'FF00;
  ASSERT_TRUE(rig.boot() && rig.enable());
  std::int64_t target = rig.drive().position_counts;
  rig.control = [&target](image::ProcessImage& image) {
    image.axes[0].drive_command.position_counts = target += 50;
  };
  rig.run(100);
  EXPECT_EQ(rig.device().position, 0x7FFF'FF00LL + 50 * 99) << "the last command is still on its way";
  EXPECT_EQ(rig.drive().position_counts, 0x7FFF'FF00LL + 50 * 98);
  EXPECT_DOUBLE_EQ(rig.drive().velocity_counts_s, 50'000.0);
}

TEST(Segment, captures_the_zero_mark_over_sdo) {
  SegmentRig rig;
  rig.start();
  rig.device().zero_mark_every = 1000;
  rig.device().position = -300;
  ASSERT_TRUE(rig.boot() && rig.enable());
  std::int64_t target = rig.drive().position_counts;
  rig.control = [&target](image::ProcessImage& image) {
    image.axes[0].drive_command.latch_arm = image.axes[0].drive.latch_sequence == 0;
    image.axes[0].drive_command.position_counts = target += 7;
  };
  ASSERT_TRUE(rig.run_until([&] { return rig.drive().latch_sequence == 1; }));
  EXPECT_EQ(rig.drive().latch_counts, 0);
  rig.run(20);
  EXPECT_EQ(rig.device().get(0x60B8, 0), 0u) << "disarmed again";
}

TEST(Segment, captures_the_zero_mark_over_pdo) {
  SegmentRig rig;
  use_full_position_map(rig.config.nodes[0].profile);
  rig.start();
  rig.device().zero_mark_every = 1000;
  rig.device().position = 500;
  ASSERT_TRUE(rig.boot() && rig.enable());
  std::int64_t target = rig.drive().position_counts;
  std::vector<std::int64_t> captures;
  rig.control = [&](image::ProcessImage& image) {
    auto& axis = image.axes[0];
    if (axis.drive.latch_sequence > captures.size()) captures.push_back(axis.drive.latch_counts);
    axis.drive_command.latch_arm =
        axis.drive.latch_sequence == captures.size() && image.now.number % 100 < 90;
    axis.drive_command.position_counts = target += 9;
    for (const auto& f : rig.network.sent) ASSERT_NE(f.id & 0x780u, 0x600u) << "no SDO is needed";
  };
  rig.run(1000);
  ASSERT_GE(captures.size(), 5u);
  for (const std::int64_t capture : captures) EXPECT_EQ(capture % 1000, 0);
}

TEST(Segment, takes_a_fault_and_a_reset) {
  SegmentRig rig;
  rig.start();
  ASSERT_TRUE(rig.boot() && rig.enable());
  std::vector<image::CanFrame> out;
  rig.device().raise_fault(0x8611, out);
  rig.network.waiting.insert(rig.network.waiting.end(), out.begin(), out.end());
  ASSERT_TRUE(rig.run_until([&] { return rig.drive().state == DriveState::fault; }, 20));
  EXPECT_EQ(rig.drive().error_code, 0x8611);
  ASSERT_EQ(rig.count(BusEventKind::emcy), 1);
  EXPECT_EQ(
      rig.sentence(BusEventKind::emcy),
      "X: emergency message 8611h: following error; error register 20h, manufacturer's bytes 01 02 03 04 05");
  rig.command().power = false;
  rig.control = nullptr;
  rig.run(50);
  EXPECT_EQ(rig.drive().state, DriveState::fault) << "nothing resets by itself";
  rig.command().reset_fault = true;
  ASSERT_TRUE(rig.run_until([&] { return rig.drive().state == DriveState::switch_on_disabled; }, 50));
  EXPECT_EQ(rig.drive().error_code, 0);
  rig.command().reset_fault = false;
  EXPECT_TRUE(rig.enable());
}

TEST(Segment, reads_the_error_code_where_no_emergency_message_came) {
  SegmentRig rig;
  rig.start();
  ASSERT_TRUE(rig.boot());
  std::vector<image::CanFrame> out;
  rig.device().raise_fault(0x3210, out);
  rig.run(20);
  EXPECT_EQ(rig.drive().state, DriveState::fault);
  EXPECT_EQ(rig.drive().error_code, 0x3210);
}

TEST(Segment, changes_the_mode_over_sdo_and_waits_for_the_drive_to_show_it) {
  SegmentRig rig;
  rig.start();
  ASSERT_TRUE(rig.boot());
  rig.command().mode = DriveMode::homing;
  rig.run(30);
  EXPECT_EQ(rig.device().get(0x6060, 0), 6u);
  EXPECT_EQ(rig.drive().mode, DriveMode::homing);
  rig.command().mode = DriveMode::csp;
  rig.run(30);
  EXPECT_EQ(rig.drive().mode, DriveMode::csp);
}

TEST(Segment, a_refused_mode_keeps_the_drive_off_and_is_named) {
  SegmentRig rig;
  rig.config.nodes[0].profile.transition_timeout_ms = 100;
  rig.start();
  ASSERT_TRUE(rig.boot());
  rig.device().aborts[0x606000] = 0x06090030;
  rig.command().mode = DriveMode::cst;
  rig.command().power = true;
  rig.run(300);
  EXPECT_EQ(rig.drive().state, DriveState::switched_on);
  EXPECT_EQ(
      rig.sentence(BusEventKind::sdo_failed),
      "X: writing 6060h:00 Modes of operation: refused by the device, the value is not allowed for this "
      "parameter (06090030h)");
  EXPECT_EQ(rig.drive().refusal.from, DriveState::switched_on);
  EXPECT_EQ(rig.drive().refusal.wanted, DriveState::operation_enabled);
  EXPECT_EQ(rig.count(BusEventKind::sdo_failed), 1) << "asked once, not for ever";
}

TEST(Segment, runs_a_spindle_in_profile_velocity) {
  SegmentRig rig(0);
  NodeConfig node;
  node.node = 9;
  node.target = DriveTarget::spindle;
  node.profile.velocity_mode = OperationMode::profile_velocity;
  node.profile.counts_per_rev = 6000;
  node.profile.velocity_unit_counts_s = 100.0;  // rpm
  use_velocity_map(node.profile);
  rig.config.nodes = {node};
  rig.start();
  ASSERT_TRUE(rig.boot());
  auto& spindle = rig.image->spindles[0];
  spindle.drive_command.power = true;
  spindle.drive_command.mode = DriveMode::csv;
  spindle.drive_command.velocity_counts_s = -150'000.0;
  rig.run(30);
  EXPECT_EQ(spindle.drive.state, DriveState::operation_enabled);
  EXPECT_EQ(spindle.drive.mode, DriveMode::csv);
  EXPECT_EQ(rig.device().get(0x6060, 0), 3u);
  EXPECT_EQ(static_cast<std::int32_t>(rig.device().get(0x60FF, 0)), -1500);
  rig.device().set(0x606C, 0, 4, static_cast<std::uint32_t>(-1499));
  rig.device().set(0x6077, 0, 2, 250);
  rig.run(15);
  EXPECT_DOUBLE_EQ(spindle.drive.velocity_counts_s, -149'900.0);
  EXPECT_DOUBLE_EQ(spindle.drive.torque_permille, 250.0);
}

TEST(Segment, runs_a_frequency_converter_in_vl_with_its_ramp_bits) {
  SegmentRig rig(0);
  NodeConfig node;
  node.node = 9;
  node.target = DriveTarget::spindle;
  node.profile.velocity_mode = OperationMode::velocity;
  node.profile.modes = supported_bit(OperationMode::velocity);
  node.profile.vl_unit_counts_s = 100.0;
  node.profile.rpdo[0].mapping.add({0x6040, 0, 16});
  node.profile.rpdo[0].mapping.add({0x6042, 0, 16});
  node.profile.tpdo[0].mapping.add({0x6041, 0, 16});
  node.profile.tpdo[0].mapping.add({0x6044, 0, 16});
  rig.config.nodes = {node};
  rig.start();
  rig.device().set(0x6502, 0, 4, 0x2);
  rig.device().set(0x6042, 0, 2, 0);
  rig.device().set(0x6044, 0, 2, static_cast<std::uint16_t>(-1490));
  ASSERT_TRUE(rig.boot());
  auto& spindle = rig.image->spindles[0];
  spindle.drive_command.power = true;
  spindle.drive_command.velocity_counts_s = -150'000.0;
  rig.run(30);
  EXPECT_EQ(rig.device().get(0x6040, 0), 0x7Fu);
  EXPECT_EQ(static_cast<std::int16_t>(rig.device().get(0x6042, 0)), -1500);
  EXPECT_DOUBLE_EQ(spindle.drive.velocity_counts_s, -149'000.0);
  spindle.drive_command.velocity_counts_s = 1e9;
  rig.run(3);
  EXPECT_EQ(static_cast<std::int16_t>(rig.device().get(0x6042, 0)), 32767);
}

TEST(Segment, a_statusword_on_every_tenth_sync_is_not_missed_in_between) {
  SegmentRig rig;
  rig.config.nodes[0].profile.tpdo[0].transmission_type = 10;
  rig.start();
  ASSERT_TRUE(rig.boot());
  for (int i = 0; i < 100; ++i) {
    rig.step();
    ASSERT_EQ(rig.drive().missed, 0u);
  }
  rig.device().silent_tpdo = true;
  rig.run(25);
  EXPECT_TRUE(rig.drive().online);
  EXPECT_GE(rig.drive().missed, 1u);
  rig.run(15);
  EXPECT_FALSE(rig.drive().online) << "three of them";
}

TEST(Segment, works_the_brake_output_of_the_drive) {
  SegmentRig rig;
  auto& profile = rig.config.nodes[0].profile;
  profile.rpdo[1].mapping.add({0x60FE, 1, 32});
  profile.brake_bit = 0;
  profile.brake_bit_releases = false;
  profile.settings = {{0x60FE, 2, 4, 1, true}};
  rig.start();
  rig.device().set(0x60FE, 1, 4, 0);
  rig.device().set(0x60FE, 2, 4, 0);
  ASSERT_TRUE(rig.boot());
  EXPECT_EQ(rig.device().writes[0], "60FE:1=1") << "engaged before anything else is written";
  EXPECT_EQ(rig.device().writes[1], "60FE:2=1");
  rig.run(3);
  EXPECT_EQ(rig.device().get(0x60FE, 1), 1u) << "1 sets the brake";
  rig.command().brake_release = true;
  rig.run(3);
  EXPECT_EQ(rig.device().get(0x60FE, 1), 0u);
}

TEST(Segment, sends_slow_and_event_driven_pdos_as_their_type_says) {
  SegmentRig rig;
  auto& profile = rig.config.nodes[0].profile;
  profile.rpdo[1].mapping.add({0x60FF, 0, 32});
  profile.rpdo[1].transmission_type = 5;
  profile.rpdo[2].mapping.add({0x60B8, 0, 16});
  profile.rpdo[2].transmission_type = 255;
  rig.start();
  ASSERT_TRUE(rig.boot());
  int slow = 0, on_event = 0;
  for (int i = 0; i < 500; ++i) {
    rig.step();
    for (const auto& f : rig.network.last_sent) {
      slow += f.id == 0x301;
      on_event += f.id == 0x401;
    }
  }
  EXPECT_EQ(slow, 100);
  EXPECT_GE(on_event, 4);
  EXPECT_LE(on_event, 7) << "only the refresh every 100 ms";
  rig.command().latch_arm = true;
  rig.run(2);
  const bool sent =
      rig.device().get(0x60B8, 0) != 0 || rig.run_until([&] { return rig.device().get(0x60B8, 0) != 0; }, 20);
  EXPECT_TRUE(sent) << "a change goes out at once";
}

TEST(Segment, measures_load_and_counts_frames) {
  SegmentRig rig(3);
  rig.start();
  ASSERT_TRUE(rig.boot());
  rig.run(1500);
  const auto& status = rig.image->segments[0];
  EXPECT_GT(status.load, 0.60);
  EXPECT_LT(status.load, 0.80) << "the plan with worst-case stuffing is the upper bound";
  EXPECT_GE(status.load_worst_cycle, status.load);
  EXPECT_GT(status.frames_sent, 4u * 1500u);
  EXPECT_GT(status.frames_received, 3u * 1500u);
  EXPECT_EQ(status.errors, 0u);
}

TEST(Segment, produces_its_own_heartbeat) {
  SegmentRig rig;
  rig.start();
  int beats = 0;
  for (int i = 0; i < 1000; ++i) {
    rig.step();
    for (const auto& f : rig.network.last_sent) beats += show(f) == "77F 05";
  }
  EXPECT_EQ(beats, 10);
}

TEST(Segment, a_configuration_that_cannot_run_is_refused) {
  testing::FakeNetwork network;
  const auto refuses = [&network](auto change) {
    SegmentRig rig(2);
    change(rig.config);
    EXPECT_THROW(Segment(network, rig.config), std::invalid_argument);
  };
  refuses([](SegmentConfig& c) { c.nodes[1].node = c.nodes[0].node; });
  refuses([](SegmentConfig& c) { c.nodes[1].node = c.own_node; });
  refuses([](SegmentConfig& c) { c.nodes[0].node = 0; });
  refuses([](SegmentConfig& c) { c.nodes[0].node = 128; });
  refuses([](SegmentConfig& c) { c.nodes[0].target_index = image::kMaxAxes; });
  refuses([](SegmentConfig& c) { c.nodes[0].profile.rpdo = {}; });
  refuses([](SegmentConfig& c) { c.nodes[0].profile.tpdo = {}; });
  refuses([](SegmentConfig& c) { c.nodes[0].profile.brake_bit = 0; });
  refuses([](SegmentConfig& c) { c.cycle_ns = 0; });
  refuses([](SegmentConfig& c) { c.index = image::kMaxSegments; });
  refuses([](SegmentConfig& c) { c.heartbeat_timeout_ms = c.heartbeat_ms; });
}

}  // namespace
}  // namespace servogate::canopen
